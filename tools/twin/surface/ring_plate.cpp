#include "tools/twin/surface/ring_plate.hpp"

#include <cmath>
#include <numbers>

#include "tools/twin/degrees.hpp"
#include "tools/twin/optics/random.hpp"
#include "tools/twin/surface/artefacts.hpp"
#include "tools/twin/surface/ball_bar.hpp"

namespace enamel::twin {
namespace {

constexpr double kFacet_mm = 0.3;            // fine enough to carry texture and seen counts
constexpr std::uint64_t kBumpStream = 7400;  // of the random numbers
constexpr double kClear_mm = 1;              // between a bump and a ball of the bar

/// Ring at z = 0, facing up.
TriSurface ring(double inner_mm, double outer_mm) {
  TriSurface out;
  const auto steps = static_cast<std::uint32_t>(std::ceil((outer_mm - inner_mm) / kFacet_mm));
  const auto turns = static_cast<std::uint32_t>(std::ceil(2 * std::numbers::pi * outer_mm / kFacet_mm));
  for (std::uint32_t j = 0; j <= steps; ++j) {
    const double r = inner_mm + (outer_mm - inner_mm) * j / steps;
    for (std::uint32_t i = 0; i < turns; ++i) {
      const double a = 2 * std::numbers::pi * i / turns;
      out.vertices.emplace_back(Vec3d(r * std::cos(a), r * std::sin(a), 0).cast<float>());
      out.normals.emplace_back(0.0F, 0.0F, 1.0F);
      out.albedo.push_back(kPlasterAlbedo);
    }
  }
  for (std::uint32_t j = 0; j < steps; ++j) {
    for (std::uint32_t i = 0; i < turns; ++i) {
      const std::uint32_t a = j * turns + i, b = j * turns + (i + 1) % turns;
      out.triangles.push_back({a, a + turns, b + turns});
      out.triangles.push_back({a, b + turns, b});
    }
  }
  return out;
}

bool is_clear(const Ball& bump, const std::vector<Ball>& bar) {
  for (const Ball& ball : bar) {
    if ((ball.centre - bump.centre).head<2>().norm() < ball.radius + bump.radius + kClear_mm) return false;
  }
  return true;
}

/// Between half a radius above and half a radius below the plate, evenly over the ring's area.
Ball bump_of(const RingPlateConfig& c, const CounterRandom& random, std::uint64_t& draw) {
  const double angle = random.uniform(draw++, 0, 2 * std::numbers::pi);
  const double area = random.uniform(draw++, c.inner_mm * c.inner_mm, c.outer_mm * c.outer_mm);
  const double radius = 0.5 * random.uniform(draw++, c.bump_mm[0], c.bump_mm[1]);
  const double z = radius * random.uniform(draw++, -0.5, 0.5);
  return {Vec3d(std::sqrt(area) * std::cos(angle), std::sqrt(area) * std::sin(angle), z), radius, kPlasterAlbedo};
}

}  // namespace

RingPlate make_ring_plate(const RingPlateConfig& c, std::uint64_t seed) {
  RingPlate out;
  const double x = 0.5 * c.distance_mm;
  std::vector<Ball> bar{{Vec3d(-x, 0, c.height_mm), 0.5 * c.diameters_mm[0], kPlasterAlbedo},
                        {Vec3d(x, 0, c.height_mm), 0.5 * c.diameters_mm[1], kPlasterAlbedo}};
  out.certificate_json = ball_certificate(bar, kMmPerUm * c.sigma_um, seed);
  Surroundings& s = out.surroundings;
  s.mesh = ring(c.inner_mm, c.outer_mm);
  if (c.rod_diameter_mm > 0) {
    append(s.mesh, ball_rod(bar[0].centre, bar[1].centre, 0.5 * c.rod_diameter_mm, kPlasterAlbedo));
  }
  s.balls = bar;
  const CounterRandom random(seed, kBumpStream);
  std::uint64_t draw = 0;
  for (int i = 0; i < c.bumps; ++i) {
    const Ball bump = bump_of(c, random, draw);
    if (is_clear(bump, bar)) s.balls.push_back(bump);
  }
  return out;
}

}  // namespace enamel::twin
