#include "calib/guide/coverage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace enamel::calib {
namespace {

constexpr double kUnreached = 1.0 / 8;  // of the depth range at either end: a tilted target's middle stays out of it
constexpr std::array<const char*, 3> kThirds{"near", "middle", "far"};
constexpr std::array<const char*, 4> kSides{"right", "bottom", "left", "top"};

struct Thirds {
  double low_mm, step_mm;
};

Thirds thirds_of(const DepthRange& range) {
  const double length = range.far_mm - range.near_mm;
  return {range.near_mm + kUnreached * length, (1 - 2 * kUnreached) * length / 3};
}

void count_field(const SeenPose& pose, const LensValues& camera, Coverage& c) {
  for (const auto& p : pose.dots_px) {
    const int column = static_cast<int>(p.x() * Coverage::kColumns / camera.width);
    const int row = static_cast<int>(p.y() * Coverage::kRows / camera.height);
    if (column >= 0 && row >= 0 && column < Coverage::kColumns && row < Coverage::kRows)
      ++c.dots_in_cell[static_cast<std::size_t>(row * Coverage::kColumns + column)];
  }
}

/// The part of the image with most empty cells.
std::string emptiest_part(const Coverage& c) {
  int best = -1;
  std::string where;
  const std::array<const char*, 3> rows{"top ", "", "bottom "};
  const std::array<const char*, 3> columns{"left", "middle", "right"};
  for (int r = 0; r < 3; ++r) {
    for (int k = 0; k < 3; ++k) {
      int empty = 0;
      for (int y = r * Coverage::kRows / 3; y < (r + 1) * Coverage::kRows / 3; ++y) {
        for (int x = k * Coverage::kColumns / 3; x < (k + 1) * Coverage::kColumns / 3; ++x)
          empty += c.dots_in_cell[static_cast<std::size_t>(y * Coverage::kColumns + x)] == 0 ? 1 : 0;
      }
      if (empty <= best) continue;
      best = empty;
      where = std::string(rows[static_cast<std::size_t>(r)]) + columns[static_cast<std::size_t>(k)];
    }
  }
  return where;
}

}  // namespace

Coverage coverage_of(const std::vector<SeenPose>& poses, const Rig& nominal, const CoverageWanted& wanted) {
  Coverage c;
  c.poses = static_cast<int>(poses.size());
  for (const SeenPose& pose : poses) {
    if (nominal.depth_range) {
      const Thirds t = thirds_of(*nominal.depth_range);
      ++c.by_depth[static_cast<std::size_t>(std::clamp(std::floor((pose.depth_mm - t.low_mm) / t.step_mm), 0.0, 2.0))];
    }
    ++c.by_side[static_cast<std::size_t>(static_cast<int>(std::lround(pose.azimuth_deg / 90.0) + 4) % 4)];
    count_field(pose, nominal.camera, c);
  }
  const auto filled = std::count_if(c.dots_in_cell.begin(), c.dots_in_cell.end(), [](int n) { return n > 0; });
  c.field_share = static_cast<double>(filled) / (Coverage::kColumns * Coverage::kRows);
  for (std::size_t i = 0; nominal.depth_range && i < c.by_depth.size(); ++i) {
    if (c.by_depth[i] >= wanted.per_third) continue;
    const Thirds t = thirds_of(*nominal.depth_range);
    c.missing.push_back(fmt::format(
        "{} depth, {:.0f} to {:.0f} mm ({} of {})", kThirds[i], t.low_mm + t.step_mm * static_cast<double>(i),
        t.low_mm + t.step_mm * static_cast<double>(i + 1), c.by_depth[i], wanted.per_third));
  }
  for (std::size_t i = 0; i < c.by_side.size(); ++i) {
    if (c.by_side[i] < wanted.per_side) c.missing.push_back(fmt::format("the board turned to the {}", kSides[i]));
  }
  if (c.field_share < wanted.field) {
    c.missing.push_back(fmt::format("dots in the {} of the image ({:.0f} % of the field seen, {:.0f} % wanted)",
                                    emptiest_part(c), 100 * c.field_share, 100 * wanted.field));
  }
  if (c.poses < wanted.poses) c.missing.push_back(fmt::format("more poses ({} of {})", c.poses, wanted.poses));
  return c;
}

}  // namespace enamel::calib
