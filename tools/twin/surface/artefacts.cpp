#include "tools/twin/surface/artefacts.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace enamel::twin {
namespace {

constexpr double kFlatFacetMm = 0.3;  // grid of flat faces: fine enough to carry texture and seen counts

/// Parallelogram a + i*e1 + j*e2 as a grid; normal e1 x e2.
TriSurface patch(const Vec3d& a, const Vec3d& e1, const Vec3d& e2, double step_mm) {
  TriSurface out;
  const auto n1 = static_cast<std::uint32_t>(std::max(1.0, std::ceil(e1.norm() / step_mm)));
  const auto n2 = static_cast<std::uint32_t>(std::max(1.0, std::ceil(e2.norm() / step_mm)));
  const Vec3f normal = e1.cross(e2).normalized().cast<float>();
  for (std::uint32_t j = 0; j <= n2; ++j) {
    for (std::uint32_t i = 0; i <= n1; ++i) {
      out.vertices.emplace_back((a + e1 * (double(i) / n1) + e2 * (double(j) / n2)).cast<float>());
      out.normals.push_back(normal);
      out.albedo.push_back(kPlasterAlbedo);
    }
  }
  for (std::uint32_t j = 0; j < n2; ++j) {
    for (std::uint32_t i = 0; i < n1; ++i) {
      const std::uint32_t v = j * (n1 + 1) + i;
      out.triangles.push_back({v, v + 1, v + n1 + 2});
      out.triangles.push_back({v, v + n1 + 2, v + n1 + 1});
    }
  }
  return out;
}

TriSurface rod_along_x(double x0, double x1, double radius) {
  TriSurface out;
  constexpr std::uint32_t kSegments = 96;
  const auto rings = static_cast<std::uint32_t>(std::ceil((x1 - x0) / kFlatFacetMm));
  for (std::uint32_t i = 0; i <= rings; ++i) {
    for (std::uint32_t k = 0; k < kSegments; ++k) {
      const double a = 2.0 * std::numbers::pi * k / kSegments;
      const Vec3d n(0, std::cos(a), std::sin(a));
      out.vertices.emplace_back((Vec3d(x0 + (x1 - x0) * i / rings, 0, 0) + radius * n).cast<float>());
      out.normals.emplace_back(n.cast<float>());
      out.albedo.push_back(kPlasterAlbedo);
    }
  }
  for (std::uint32_t i = 0; i < rings; ++i) {
    for (std::uint32_t k = 0; k < kSegments; ++k) {
      const std::uint32_t a = i * kSegments + k, b = i * kSegments + (k + 1) % kSegments;
      out.triangles.push_back({a, b, b + kSegments});
      out.triangles.push_back({a, b + kSegments, a + kSegments});
    }
  }
  return out;
}

/// Heights over x as vertical and horizontal strips, |y - y_mid| <= half width. knots: x where the height changes.
void add_profile(TriSurface& out, const std::vector<double>& x, const std::vector<double>& height, double y_mid,
                 double width) {
  const Vec3d across(0, width, 0);
  const double y0 = y_mid - width / 2;
  for (std::size_t i = 0; i < height.size(); ++i) {
    append(out, patch(Vec3d(x[i], y0, height[i]), Vec3d(x[i + 1] - x[i], 0, 0), across, kFlatFacetMm));
    if (i + 1 == height.size() || height[i + 1] == height[i]) continue;
    const Vec3d wall(0, 0, height[i + 1] - height[i]);
    const Vec3d foot(x[i + 1], y0, height[i]);
    // A wall that rises with x faces -x, one that falls faces +x.
    if (wall.z() > 0) {
      append(out, patch(foot, wall, across, kFlatFacetMm));
    } else {
      append(out, patch(foot + wall, across, -wall, kFlatFacetMm));
    }
  }
}

}  // namespace

Surroundings make_plane(const PlaneConfig& config) {
  Surroundings out;
  const double h = config.half_mm;
  out.mesh = patch(Vec3d(-h, -h, 0), Vec3d(2 * h, 0, 0), Vec3d(0, 2 * h, 0), config.grid_mm);
  return out;
}

Surroundings make_spheres(const SpheresConfig& config) {
  Surroundings out;
  const double span = config.pitch_mm * static_cast<double>(config.diameters_mm.size() - 1);
  for (std::size_t i = 0; i < config.diameters_mm.size(); ++i) {
    const double x = -span / 2 + config.pitch_mm * static_cast<double>(i);
    out.balls.push_back({Vec3d(x, 0, 0), config.diameters_mm[i] / 2, kPlasterAlbedo});
  }
  constexpr double kOverhangMm = 6;
  if (config.rod_diameter_mm > 0) {
    out.mesh = rod_along_x(-span / 2 - kOverhangMm, span / 2 + kOverhangMm, config.rod_diameter_mm / 2);
  }
  return out;
}

Surroundings make_steps(const StepsConfig& config) {
  Surroundings out;
  std::vector<double> x, heights{0.0};
  const double span = config.tread_mm * static_cast<double>(config.rises_mm.size() + 1);
  for (const double rise : config.rises_mm) heights.push_back(heights.back() + rise);
  for (std::size_t i = 0; i <= heights.size(); ++i) x.push_back(-span / 2 + config.tread_mm * static_cast<double>(i));
  // Middle height at z = 0, so that the whole block stays within the depth range about one distance.
  const auto [lo, hi] = std::minmax_element(heights.begin(), heights.end());
  const double mid = 0.5 * (*lo + *hi);
  for (double& h : heights) h -= mid;
  add_profile(out.mesh, x, heights, config.width_mm / 2, config.width_mm);
  if (config.slot_widths_mm.empty()) return out;
  std::vector<double> sx{-span / 2}, sh;
  double at = -span / 2;
  for (const double slot : config.slot_widths_mm) {
    at += config.tread_mm;
    sx.push_back(at);
    sh.push_back(0.0);
    at += slot;
    sx.push_back(at);
    sh.push_back(-config.slot_depth_mm);
  }
  sx.push_back(at + config.tread_mm);
  sh.push_back(0.0);
  add_profile(out.mesh, sx, sh, -config.width_mm / 2, config.width_mm);
  return out;
}

}  // namespace enamel::twin
