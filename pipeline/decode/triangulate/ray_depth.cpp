#include "pipeline/decode/triangulate/ray_depth.hpp"

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "pipeline/decode/triangulate/chosen.hpp"

namespace enamel::pipeline {
namespace {

using Nodes = std::array<double, kDepthNodes>;

/// Chebyshev nodes of 1/z, first and last exactly on the range's ends so that the fit is never extrapolated.
Nodes inverse_depth_nodes(calib::DepthRange range) {
  const double low = 1 / range.far_mm, high = 1 / range.near_mm;
  Nodes q{};
  for (int i = 0; i < kDepthNodes; ++i) {
    q[static_cast<std::size_t>(i)] =
        0.5 * (low + high) - 0.5 * (high - low) * std::cos(std::numbers::pi * i / (kDepthNodes - 1));
  }
  return q;
}

bool in_front(const calib::Rig& rig, calib::PlanePoint ray, double z_mm) {
  const auto& row = rig.T_proj_cam[2];
  return (row[0] * ray.x + row[1] * ray.y + row[2]) * z_mm + row[3] > 1e-3 * z_mm;
}

struct Cubic {
  std::array<double, 4> c{};
  double mid = 0, near = 0, far = 0;
  bool ok = false;
};

/// The measured 1/z of what the parametric model puts at 1/z = q on the ray of a pixel.
double corrected(const calib::Rig& rig, calib::PlanePoint pixel, double q) {
  return rig.correction ? q + calib::correction_at(*rig.correction, pixel.x, pixel.y, q) : q;
}

Cubic fit_pixel(const calib::Rig& rig, calib::PlanePoint pixel, calib::PlanePoint ray, const Nodes& q,
                double rad_per_px) {
  Cubic out;
  Nodes phase{};
  for (std::size_t i = 0; i < kDepthNodes; ++i) {
    if (!in_front(rig, ray, 1 / q[i])) return out;
    phase[i] = rad_per_px * calib::project_to_projector(rig, ray, 1 / q[i]).x;
    if (!std::isfinite(phase[i])) return out;
    if (i >= 2 && (phase[i] - phase[i - 1]) * (phase[1] - phase[0]) <= 0) return out;
  }
  out.far = phase.front();
  out.near = phase.back();
  out.mid = phase[kDepthNodes / 2];
  const double half = 0.5 * std::abs(out.near - out.far);
  if (!(half > kMinHalfRange_rad)) return out;
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (std::size_t i = 0; i < kDepthNodes; ++i) {
    const double t = (phase[i] - out.mid) / half;
    const Eigen::Vector4d row(1, t, t * t, t * t * t);
    normal += row * row.transpose();
    right += row * corrected(rig, pixel, q[i]);
  }
  const Eigen::Vector4d c = normal.ldlt().solve(right);
  for (int k = 0; k < 4; ++k) out.c[static_cast<std::size_t>(k)] = c[k] / std::pow(half, k);
  out.ok = true;
  return out;
}

/// -R' t of T_proj_cam.
Vec3f projector_centre(const calib::Rig& rig) {
  const auto& T = rig.T_proj_cam;
  Vec3f centre;
  for (std::size_t k = 0; k < 3; ++k) {
    const double turned = T[0][k] * T[0][3] + T[1][k] * T[1][3] + T[2][k] * T[2][3];
    centre[static_cast<Eigen::Index>(k)] = static_cast<float>(-turned);
  }
  return centre;
}

/// Of both directions.
InverseDepthTable every_second(const RayDepth& rays) {
  InverseDepthTable out;
  for (int v = 0; v < rays.height; v += 2) {
    for (int u = 0; u < rays.width; u += 2) {
      const auto i = static_cast<std::size_t>(v) * static_cast<std::size_t>(rays.width) + static_cast<std::size_t>(u);
      out.phase_mid_rad.push_back(rays.phase_mid_rad[i]);
      out.c0.push_back(rays.c0[i]), out.c1.push_back(rays.c1[i]);
      out.c2.push_back(rays.c2[i]), out.c3.push_back(rays.c3[i]);
    }
  }
  return out;
}

}  // namespace

Result<RayDepth> RayDepth::bake(const calib::Rig& rig, calib::DepthRange range) {
  const double rad_per_px = 2 * std::numbers::pi / rig.patterns.period_px;
  const Nodes q = inverse_depth_nodes(range);
  RayDepth out;
  out.width = rig.camera.width;
  out.height = rig.camera.height;
  out.near_mm = static_cast<float>(range.near_mm);
  out.far_mm = static_cast<float>(range.far_mm);
  out.rays = calib::make_ray_table(rig.camera);
  out.projector_mm = projector_centre(rig);
  for (std::size_t k = 0; k < 3; ++k)
    out.projector_axis[static_cast<Eigen::Index>(k)] = static_cast<float>(rig.T_proj_cam[2][k]);
  out.min_phase_rad = static_cast<float>(-0.5 * rad_per_px);
  out.max_phase_rad = static_cast<float>((rig.projector.width - 0.5) * rad_per_px);
  const std::size_t n = static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height);
  for (auto* a : {&out.phase_mid_rad, &out.c0, &out.c1, &out.c2, &out.c3, &out.phase_near_rad, &out.phase_far_rad})
    a->reserve(n);
  for (int v = 0; v < out.height; ++v) {
    for (int u = 0; u < out.width; ++u) {
      const calib::PlanePoint pixel{static_cast<double>(u), static_cast<double>(v)};
      const Cubic cubic = fit_pixel(rig, pixel, calib::undistort(rig.camera, pixel), q, rad_per_px);
      if (!cubic.ok) {
        return fail(ErrorCode::kRigInvalid, "pixel " + std::to_string(u) + "," + std::to_string(v) +
                                                ": the projector's phase does not determine depth on this ray");
      }
      out.phase_mid_rad.push_back(static_cast<float>(cubic.mid));
      // The stored middle is rounded: move the constant along so that the polynomial still meets the exact curve.
      const double shift = static_cast<double>(out.phase_mid_rad.back()) - cubic.mid;
      out.c0.push_back(static_cast<float>(cubic.c[0] + shift * cubic.c[1]));
      out.c1.push_back(static_cast<float>(cubic.c[1]));
      out.c2.push_back(static_cast<float>(cubic.c[2]));
      out.c3.push_back(static_cast<float>(cubic.c[3]));
      out.phase_near_rad.push_back(static_cast<float>(cubic.near));
      out.phase_far_rad.push_back(static_cast<float>(cubic.far));
    }
  }
  out.sparse = every_second(out);
  return out;
}

std::optional<double> depth_by_iteration(const calib::Rig& rig, calib::PlanePoint ray, double phase_rad,
                                         double start_mm) {
  const double rad_per_px = 2 * std::numbers::pi / rig.patterns.period_px;
  const double target_px = phase_rad / rad_per_px;
  double q = 1 / start_mm;  // Newton in 1/z, where the function is nearly linear
  for (int step = 0; step < 50; ++step) {
    const double h = 1e-6 * q;
    const double f = calib::project_to_projector(rig, ray, 1 / q).x - target_px;
    const double slope = (calib::project_to_projector(rig, ray, 1 / (q + h)).x - f - target_px) / h;
    const double dq = -f / slope;
    if (!std::isfinite(dq)) return std::nullopt;
    q += dq;
    if (!(q > 0)) return std::nullopt;
    if (std::abs(dq) < 1e-12 * q) return 1 / corrected(rig, calib::project(rig.camera, ray), q);
  }
  return std::nullopt;
}

}  // namespace enamel::pipeline
