// Mirror light of rough and smooth surfaces, and refraction. Directions are unit vectors away from the surface.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace enamel::twin {

/// Reflectance at `cosine` to the normal (Schlick 1994).
[[nodiscard]] inline double schlick(double normal_reflectance, double cosine) {
  const double x = std::clamp(1.0 - cosine, 0.0, 1.0), x2 = x * x;
  return normal_reflectance + (1.0 - normal_reflectance) * x2 * x2 * x;
}

/// pi * f_r * cos(light) of microfacets: GGX distribution, Smith's height-correlated shadowing (Walter 2007, Heitz
/// 2014). The factor pi makes it comparable with an albedo times the cosine. Zero from below the horizon.
[[nodiscard]] inline double facet_mirror(const Eigen::Vector3d& n, const Eigen::Vector3d& to_light,
                                         const Eigen::Vector3d& to_camera, double alpha, double normal_reflectance) {
  const double nl = n.dot(to_light), nc = n.dot(to_camera);
  if (nl <= 0 || nc <= 0) return 0;
  const Eigen::Vector3d half = (to_light + to_camera).normalized();
  const double nh = n.dot(half), a2 = alpha * alpha;
  const double d = nh * nh * (a2 - 1.0) + 1.0;
  const double distribution = a2 / (std::numbers::pi * d * d);
  const double smith_l = nc * std::sqrt(nl * nl * (1.0 - a2) + a2), smith_c = nl * std::sqrt(nc * nc * (1.0 - a2) + a2);
  const double visibility = 0.5 / (smith_l + smith_c);
  return std::numbers::pi * distribution * visibility * schlick(normal_reflectance, half.dot(to_light)) * nl;
}

/// Where light from `away` (towards its source) goes on behind the surface, away from the source: Snell's law. ratio:
/// index outside over inside. Nothing when `away` lies below the horizon or all light is reflected.
[[nodiscard]] inline std::optional<Eigen::Vector3d> refract(const Eigen::Vector3d& away, const Eigen::Vector3d& n,
                                                            double ratio) {
  const double cosine = n.dot(away);
  const double sine2 = ratio * ratio * (1.0 - cosine * cosine);
  if (cosine <= 0 || sine2 >= 1.0) return std::nullopt;
  return Eigen::Vector3d(-ratio * away + (ratio * cosine - std::sqrt(1.0 - sine2)) * n);
}

}  // namespace enamel::twin
