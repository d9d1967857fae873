#include "tests/support/draw/conditions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace enamel::test {
namespace {

/// 0 at 0, 1 at 1.
double s_curve(double x, double steep) {
  if (steep <= 0) return x * x * (3 - 2 * x);
  const auto logistic = [&](double t) { return 1 / (1 + std::exp(-steep * (t - 0.5))); };
  return (logistic(x) - logistic(0)) / (logistic(1) - logistic(0));
}

}  // namespace

double Response::emission(double level) const {
  const double x = std::clamp(level / 255, 0.0, 1.0);
  double e = x;
  if (kind == ResponseKind::kBow) e = x + bow * 4 * x * (1 - x) + skew * 10.4 * x * (1 - x) * (1 - 2 * x);
  if (kind == ResponseKind::kGamma) e = std::pow(x, gamma);
  if (kind == ResponseKind::kS) e = (1 - s_share) * std::pow(x, gamma) + s_share * s_curve(std::pow(x, gamma), steep);
  return dark + (1 - dark) * e;
}

Eigen::Isometry3d DrawnMotion::at(double time_s) const {
  const double turn = turn_rad_s.norm();
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  if (turn > 0) out.linear() = Eigen::AngleAxisd(turn * time_s, turn_rad_s / turn).toRotationMatrix();
  out.translation() = pivot_mm - out.linear() * pivot_mm + velocity_mm_s * time_s;
  return out;
}

int response_class(const Drawn& d) {
  if (d.response.kind == ResponseKind::kBow) return 0;
  if (d.response.kind == ResponseKind::kS) return 4;
  return d.response.gamma < 1.4 ? 1 : d.response.gamma < 2 ? 2 : 3;
}

int motion_band(const Drawn& d) {
  const double speed = d.motion.velocity_mm_s.norm();
  return speed <= 0 ? 0 : speed < 10 ? 1 : speed < 20 ? 2 : 3;
}

int albedo_band(const Drawn& d) { return d.paint.albedo < 0.2 ? 0 : d.paint.albedo < 0.5 ? 1 : 2; }

int view_band(const Drawn& d) {
  const double view_px = d.rig.camera.width / d.rig.camera.fx * d.rig.projector.fx;
  const double fringes = view_px / d.rig.patterns.period_px;
  return fringes < 8 ? 0 : fringes < 14 ? 1 : 2;
}

std::string describe(const Drawn& d) {
  const auto& r = d.response;
  const auto& p = d.rig.patterns;
  const auto name = [](const auto& names, int k) { return names[static_cast<std::size_t>(k)]; };
  std::string response = fmt::format("gamma {:.2f}", r.gamma);
  if (r.kind == ResponseKind::kBow) response = fmt::format("bow {:+.3f} {:+.3f}", r.bow, r.skew);
  if (r.kind == ResponseKind::kS) response += fmt::format(" S {:.2f} steep {:.1f}", r.s_share, r.steep);
  return fmt::format(
      "{} {} seed {} | {} | {} {}x{} z {:.1f} albedo {:.2f} haze {:.2f} stripes {} | {:.1f} mm/s {:.1f} deg/s | period "
      "{:.1f} baseline {:.1f} fx {:.0f} | light {:.2f} psf {:.2f} blur {:.2f} {:.2f} prnu {:.3f}",
      p.mode == calib::PatternMode::kMicro ? "M" : "T", d.attempt, d.seed, response,
      name(kSceneNames, static_cast<int>(d.scene.kind)), d.rig.camera.width, d.rig.camera.height,
      d.scene.T_cam_scene.translation().z(), d.paint.albedo, d.paint.haze, d.paint.stripes.size(),
      d.motion.velocity_mm_s.norm(), d.motion.turn_rad_s.norm() * 57.2958, p.period_px,
      std::hypot(d.rig.T_proj_cam[0][3], d.rig.T_proj_cam[2][3]), d.rig.camera.fx, d.optics.exposure, d.optics.psf_px,
      d.optics.blur_px, d.optics.blur_px_per_mm, d.optics.prnu);
}

}  // namespace enamel::test
