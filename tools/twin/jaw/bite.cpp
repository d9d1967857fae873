#include "tools/twin/jaw/bite.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace enamel::twin {
namespace {

constexpr double kMapCellMm = 0.25;  // chosen: edges of 0.1 to 0.3 mm leave hardly a cell of a tooth empty
constexpr double kMapHalfMm = 50;    // beyond any arch
constexpr int kMapCells = static_cast<int>(2 * kMapHalfMm / kMapCellMm);
constexpr int kSideways = 4, kForwards = 12;  // chosen: cells that the upper may be shifted: 1 mm, 3 mm
constexpr double kPaperMm = 0.02;             // chosen: articulating paper

/// How high a jaw stands over the plane, by cells; -inf where it does not.
std::vector<float> heights(const TriSurface& mesh, const Eigen::Isometry3d& T) {
  std::vector<float> out(std::size_t{kMapCells} * kMapCells, -std::numeric_limits<float>::infinity());
  for (const Vec3f& v : mesh.vertices) {
    const Vec3d p = T * v.cast<double>();
    const int x = static_cast<int>(std::floor((p.x() + kMapHalfMm) / kMapCellMm));
    const int y = static_cast<int>(std::floor((p.y() + kMapHalfMm) / kMapCellMm));
    if (x < 0 || y < 0 || x >= kMapCells || y >= kMapCells) continue;
    float& cell = out[static_cast<std::size_t>(y) * kMapCells + static_cast<std::size_t>(x)];
    cell = std::max(cell, static_cast<float>(v.z()));
  }
  return out;
}

/// The z at which the upper, turned over and shifted by so many cells, first meets the lower.
float meets_at(const std::vector<float>& lower, const std::vector<float>& upper, int dx, int dy) {
  float z = -std::numeric_limits<float>::infinity();
  for (int y = std::max(0, dy); y < std::min(kMapCells, kMapCells + dy); ++y) {
    const float* below = lower.data() + static_cast<std::size_t>(y) * kMapCells;
    const float* above = upper.data() + static_cast<std::size_t>(y - dy) * kMapCells;
    for (int x = std::max(0, dx); x < std::min(kMapCells, kMapCells + dx); ++x)
      z = std::max(z, below[x] + above[x - dx]);
  }
  return z;
}

/// Deepest of all shifts.
Eigen::Isometry3d close_on(const TriSurface& lower, const TriSurface& upper) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitY()).toRotationMatrix();
  const std::vector<float> below = heights(lower, Eigen::Isometry3d::Identity()), above = heights(upper, T);
  float deepest = std::numeric_limits<float>::infinity();
  for (int dy = 0; dy <= kForwards; ++dy) {
    for (int dx = -kSideways; dx <= kSideways; ++dx) {
      const float z = meets_at(below, above, dx, dy);
      if (!std::isfinite(z) || z >= deepest) continue;
      deepest = z;
      T.translation() = Eigen::Vector3d(dx * kMapCellMm, dy * kMapCellMm, static_cast<double>(z) + kPaperMm);
    }
  }
  return T;
}

void move(TriSurface& mesh, const Eigen::Isometry3d& T) {
  for (Vec3f& v : mesh.vertices) v = (T * v.cast<double>()).cast<float>();
  for (Vec3f& n : mesh.normals) n = (T.linear() * n.cast<double>()).cast<float>();
}

}  // namespace

JawConfig jaw_in_bite(JawConfig config, JawSide side) {
  config.side = side;
  config.both_sides = true;
  config.palate = false;
  if (side == JawSide::kUpper) {
    const double from_mm = config.from_mm;
    config.from_mm = -config.to_mm;
    config.to_mm = -from_mm;
  }
  return config;
}

Bite make_bite(const JawConfig& config, std::uint64_t seed) {
  Jaw lower = make_jaw(jaw_in_bite(config, JawSide::kLower), seed);
  Jaw upper = make_jaw(jaw_in_bite(config, JawSide::kUpper), seed);
  const Eigen::Isometry3d T_lower_upper = close_on(lower.mesh, upper.mesh);
  const Arch arch(lower.dentition.shape);
  const double middle_mm = config.to_mm > config.from_mm ? 0.5 * (config.from_mm + config.to_mm) : 0;
  const Eigen::Vector2d at = arch.point(middle_mm), out = arch.buccal(middle_mm);
  Eigen::Isometry3d T_lower_bite = Eigen::Isometry3d::Identity();
  T_lower_bite.linear().col(2) = Eigen::Vector3d(out.x(), out.y(), 0);
  T_lower_bite.linear().col(0) = Eigen::Vector3d::UnitZ();
  T_lower_bite.linear().col(1) = T_lower_bite.linear().col(2).cross(T_lower_bite.linear().col(0));
  T_lower_bite.translation() = Eigen::Vector3d(at.x(), at.y(), 0.5 * T_lower_upper.translation().z());
  Bite bite;
  bite.T_bite_lower = T_lower_bite.inverse();
  bite.T_bite_upper = bite.T_bite_lower * T_lower_upper;
  move(lower.mesh, bite.T_bite_lower);
  move(upper.mesh, bite.T_bite_upper);
  bite.mesh = std::move(lower.mesh);
  append(bite.mesh, upper.mesh);
  return bite;
}

}  // namespace enamel::twin
