// A textured ball under the projector's light that moves between the frames of a burst, rendered at each frame's time.
// Units: mm, rad and frame intervals; `tau` counts from mid-burst. Not thread-safe.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "pipeline/decode/burst_decoder.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::test {

/// The ball seen `tau` frame intervals after mid-burst: depth, and the projector's light on it (Lambert).
struct MovingBall {
  calib::Rig rig;
  Eigen::Vector3d shift_mm, turn_rad;
  double harmonic = 0;  ///< projector's B2/B
  double radius_mm = 9;
  Eigen::Vector3d centre_mm{1.0, -0.5, 55.5};
  double texture = 0.12;  ///< that sits on it
  double fissure = 0;     ///< darkness of lines along y on it, 1 mm apart and 0.04 mm wide (standard deviation)
  bool lens = true;       ///< lenses darken towards their border

  [[nodiscard]] MovingBall at_rest() const {
    MovingBall out = *this;
    out.shift_mm = out.turn_rad = Eigen::Vector3d::Zero();
    return out;
  }
  [[nodiscard]] Eigen::AngleAxisd turn(double tau) const {
    const double angle = turn_rad.norm() * tau;
    return {angle, angle != 0 ? Eigen::Vector3d(turn_rad.normalized()) : Eigen::Vector3d(Eigen::Vector3d::UnitX())};
  }
  [[nodiscard]] Eigen::Vector3d ray(int u, int v) const {
    const auto p = calib::undistort(rig.camera, {static_cast<double>(u), static_cast<double>(v)});
    return {p.x, p.y, 1};
  }
  /// Turns are about the ball's centre. NaN beside the ball.
  [[nodiscard]] double depth(int u, int v, double tau) const {
    const Eigen::Vector3d r = ray(u, v), c = centre_mm + tau * shift_mm;
    const double rc = r.dot(c), rr = r.squaredNorm();
    return (rc - std::sqrt(rc * rc - rr * (c.squaredNorm() - radius_mm * radius_mm))) / rr;
  }
  [[nodiscard]] Eigen::Vector3d projector_mm() const {
    Eigen::Matrix4d T_proj_cam;
    for (int row = 0; row < 4; ++row) {
      for (int column = 0; column < 4; ++column)
        T_proj_cam(row, column) = rig.T_proj_cam[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
    }
    return T_proj_cam.inverse().topRightCorner<3, 1>();
  }
  [[nodiscard]] double light(int u, int v, double tau) const {
    const double z = depth(u, v, tau);
    if (!(z > 0)) return 0;
    const Eigen::Vector3d p = ray(u, v) * z - centre_mm - tau * shift_mm;
    const Eigen::Vector3d on_ball = turn(tau).inverse() * p;
    const double from_line = on_ball.x() - std::round(on_ball.x());
    const double albedo = (0.8 + texture * std::sin(3 * on_ball.x()) * std::cos(2.3 * on_ball.y() + 0.4)) *
                          (1 - fissure * std::exp(-0.5 * std::pow(from_line / 0.04, 2)));
    const Eigen::Vector3d to_light = projector_mm() - (ray(u, v) * z);
    const double facing = std::max(0.0, p.normalized().dot(to_light));
    const double falloff = lens ? lens_falloff(rig, ray(u, v).x(), ray(u, v).y(), z) : 1.0;
    return albedo * std::pow(45.0, 2) * falloff * facing / std::pow(to_light.norm(), 3);
  }
  [[nodiscard]] FrameSet render(bool noise) const {
    return frames_in_motion([&](double tau) {
      SceneOptions o;
      o.noise = noise;
      o.harmonic = harmonic;
      o.light = [&](int u, int v) { return light(u, v, tau); };
      return test::render(
          rig, [&](int u, int v) { return std::max(40.0, depth(u, v, tau)); }, o);
    });
  }
  /// Mean depth error where the normal's x lies between those given, um.
  [[nodiscard]] double error_um(const pipeline::DecodedBurst& burst, double from, double to) const {
    double sum = 0, count = 0;
    for (int v = 0; v < rig.camera.height; ++v) {
      for (int u = 0; u < rig.camera.width; ++u) {
        const double truth = depth(u, v, 0), error = 1e3 * (static_cast<double>(burst.patch.depth_mm(u, v)) - truth);
        const Eigen::Vector3d n = (ray(u, v) * truth - centre_mm) / radius_mm;
        if (!(n.x() > from && n.x() < to && std::abs(n.y()) < 0.6 && std::abs(error) < 100)) continue;
        sum += error, count += 1;
      }
    }
    EXPECT_GT(count, 1000);
    return sum / count;
  }
  /// Mean depth error of a strip of the image's columns, um.
  [[nodiscard]] double strip_error_um(const pipeline::DecodedBurst& burst, int begin, int end) const {
    double sum = 0, count = 0;
    for (int v = 0; v < rig.camera.height; ++v) {
      for (int u = begin; u < end; ++u) {
        const double error = 1e3 * (static_cast<double>(burst.patch.depth_mm(u, v)) - depth(u, v, 0));
        if (!(std::abs(error) < 100)) continue;
        sum += error, count += 1;
      }
    }
    EXPECT_GT(count, 500);
    return sum / count;
  }
  /// 1.48 times the median deviation of depth at mid-burst, um: what ripple and noise do, not a few pixels at edges.
  [[nodiscard]] double sigma_um(const pipeline::DecodedBurst& burst) const {
    std::vector<double> errors;
    for (int v = 0; v < rig.camera.height; ++v) {
      for (int u = 0; u < rig.camera.width; ++u) {
        const auto z = static_cast<double>(burst.patch.depth_mm(u, v));
        if (z == z) errors.push_back(1e3 * std::abs(z - depth(u, v, 0)));
      }
    }
    std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2), errors.end());
    return 1.4826 * errors[errors.size() / 2];
  }
};

/// Tests of both modes: false is T, true M.
class BothModes : public testing::TestWithParam<bool> {
 protected:
  static calib::Rig rig() { return GetParam() ? micro_rig(480, 360) : cropped_rig(480, 360); }
};

}  // namespace enamel::test
