#include "tools/twin/surface/dot_board.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "protocol/base/json_text.hpp"
#include "tools/twin/degrees.hpp"
#include "tools/twin/optics/random.hpp"

namespace enamel::twin {
namespace {

constexpr double kBoardFacetMm = 0.2;       // a bow of 20 um leaves the facets by 2 nm
constexpr std::uint64_t kDotStream = 7001;  // of the random numbers

/// Board |x| <= a, |y| <= b about `middle` as a grid of facets, bowed.
TriSurface bowed_sheet(double a, double b, double bow_mm, const Eigen::Vector2d& middle) {
  TriSurface out;
  const auto n1 = static_cast<std::uint32_t>(std::ceil(2 * a / kBoardFacetMm));
  const auto n2 = static_cast<std::uint32_t>(std::ceil(2 * b / kBoardFacetMm));
  const double per_mm2 = bow_mm / (a * a + b * b);
  for (std::uint32_t j = 0; j <= n2; ++j) {
    for (std::uint32_t i = 0; i <= n1; ++i) {
      const double x = -a + 2 * a * i / n1, y = -b + 2 * b * j / n2;
      out.vertices.emplace_back(
          Vec3d(x + middle.x(), y + middle.y(), bow_mm - per_mm2 * (x * x + y * y)).cast<float>());
      out.normals.emplace_back(Vec3d(2 * per_mm2 * x, 2 * per_mm2 * y, 1).normalized().cast<float>());
    }
  }
  out.albedo.assign(out.vertices.size(), 0.0F);
  for (std::uint32_t j = 0; j < n2; ++j) {
    for (std::uint32_t i = 0; i < n1; ++i) {
      const std::uint32_t v = j * (n1 + 1) + i;
      out.triangles.push_back({v, v + 1, v + n1 + 2});
      out.triangles.push_back({v, v + n1 + 2, v + n1 + 1});
    }
  }
  return out;
}

}  // namespace

Surroundings make_dot_board(const DotBoardConfig& c, std::uint64_t seed) {
  DotPrint print;
  print.cols = c.cols;
  print.rows = c.rows;
  print.pitch_mm = c.pitch_mm;
  print.radius_mm = c.radius_mm;
  print.dot_albedo = static_cast<float>(c.dot_albedo);
  print.ground_albedo = static_cast<float>(c.ground_albedo);
  print.ring_inner_mm = c.ring_inner_mm;
  for (const std::string& row : c.rings)
    for (const char each : row) print.is_ring.push_back(each == '1');
  const CounterRandom random(seed, kDotStream);
  for (int i = 0; i < c.cols * c.rows; ++i) {
    const NormalPair g = random.normals(static_cast<std::uint64_t>(i));
    print.offsets_mm.push_back(c.dot_error_um * kMmPerUm * Eigen::Vector2d(g.a, g.b));
  }
  print.middles_mm.emplace_back(0, 0);
  if (c.is_doubled) print.middles_mm.emplace_back(0, 2 * c.half_height_mm());
  Surroundings out;
  for (const Eigen::Vector2d& middle : print.middles_mm)
    append(out.mesh, bowed_sheet(c.half_width_mm(), c.half_height_mm(), c.bow_um * kMmPerUm, middle));
  out.print = std::move(print);
  return out;
}

std::string target_json(const DotBoardConfig& c) {
  nlohmann::ordered_json json{{"type", c.rings.empty() ? "circle_grid" : "coded_dots"},
                              {"cols", c.cols},
                              {"rows", c.rows},
                              {"pitch_mm", c.pitch_mm},
                              {"radius_mm", c.radius_mm}};
  if (!c.rings.empty()) json["ring_inner_mm"] = c.ring_inner_mm;
  json["circles"] = "white on dark";
  if (!c.rings.empty()) json["rings"] = c.rings;
  return json_text(json, 1) + "\n";
}

}  // namespace enamel::twin
