#include "tools/twin/jaw/jaw.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "tools/twin/jaw/polygonise.hpp"

namespace enamel::twin {
namespace {

constexpr double kInsideMm = 9.5, kOutsideMm = 8.0;  // width of the strip about the arch
constexpr double kPalateMm = 40;                     // beyond the middle of any arch
constexpr double kLowZ = -13, kHighZ = 13;

struct Strip {
  double from, to;  ///< arc length
  double inside;    ///< width on the inside of the arch
  double back;      ///< y behind which nothing is kept: there the two sides of the arch meet in no seam

  [[nodiscard]] double beyond(const ArchCoordinates::At& a, const Eigen::Vector3d& p) const {
    return std::max({from - a.s, a.s - to, -inside - a.n, a.n - kOutsideMm, back - p.y()});
  }
};

Strip strip_of(const JawConfig& config, const Dentition& d) {
  constexpr double kBeyond = 3.5;
  constexpr double kNowhereBehind = -1e9;
  Strip strip{config.from_mm, config.to_mm, config.palate ? kPalateMm : kInsideMm, kNowhereBehind};
  if (config.to_mm <= config.from_mm) {
    strip.from = d.teeth.front().s - 0.5 * d.teeth.front().form.mesiodistal - kBeyond;
    strip.to = d.teeth.back().s + 0.5 * d.teeth.back().form.mesiodistal + kBeyond;
  }
  const Arch arch(d.shape);
  if (config.palate) strip.back = std::min(arch.point(strip.from).y(), arch.point(strip.to).y());
  return strip;
}

/// Box about the strip, by walking along its two borders.
void bound(const Strip& strip, const Arch& arch, Eigen::Vector3d& low, Eigen::Vector3d& high) {
  low = {1e9, 1e9, kLowZ};
  high = {-1e9, -1e9, kHighZ};
  for (double s = strip.from; s <= strip.to; s += 0.5) {
    for (const double n : {-strip.inside, kOutsideMm}) {
      const Eigen::Vector2d p = arch.point(s) + n * arch.buccal(s);
      low.head<2>() = low.head<2>().cwiseMin(p);
      high.head<2>() = high.head<2>().cwiseMax(p);
    }
  }
}

}  // namespace

Jaw make_jaw(const JawConfig& config, std::uint64_t seed) {
  Jaw jaw;
  jaw.dentition = make_dentition(config.side, config.last_tooth, config.both_sides, seed);
  const JawField field(jaw.dentition, config.side, seed,
                       config.palate ? JawField::Inside::kVault : JawField::Inside::kRim);
  const Strip strip = strip_of(config, jaw.dentition);
  PolygoniseConfig pc;
  pc.lipschitz = JawField::kLipschitz;
  pc.cell_mm = 0.7 * config.max_edge_mm;  // diagonals of the net's quads then stay about max_edge_mm
  bound(strip, Arch(jaw.dentition.shape), pc.low, pc.high);
  jaw.mesh = polygonise(
      pc,
      [&](const Eigen::Vector3d& p) {
        // Well outside the strip nothing is kept, so nothing need be searched; the factor allows for s being stretched
        // on the inside of the curve.
        const double beyond = strip.beyond(field.arch_at(p), p);
        return beyond > 1.0 ? 0.3 * beyond : field.value(p);
      },
      [&](const Eigen::Vector3d& p) { return strip.beyond(field.arch_at(p), p) <= 0; });
  tbb::parallel_for(std::size_t{0}, jaw.mesh.vertices.size(), [&](std::size_t i) {
    const auto sample = field.sample(jaw.mesh.vertices[i].cast<double>());
    constexpr double kStain = 0.22;
    const double tooth = config.enamel_albedo * (1.0 - kStain * sample.groove);
    jaw.mesh.albedo[i] = static_cast<float>(sample.enamel * tooth + (1.0 - sample.enamel) * config.gum_albedo);
  });
  refine_edges(jaw.mesh, config.max_edge_mm);
  return jaw;
}

}  // namespace enamel::twin
