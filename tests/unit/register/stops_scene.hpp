// A drawn desktop mount before an endless synthetic surface: stops at poses that are known exactly, with what tables
// and models do by themselves. Test support only.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "pipeline/register/stops/lay_stops.hpp"
#include "tests/unit/register/synthetic_surface.hpp"

namespace enamel::testing {

inline calib::Triple triple(const Vec3d& v) { return {v.x(), v.y(), v.z()}; }
inline Vec3d vec(const calib::Triple& t) { return Vec3d(t.data()); }
inline double drawn_in(std::uint64_t key, double from, double to) { return from + (to - from) * uniform(key); }
inline constexpr double kRho_mm = 4.5;  // as IcpConfig::rho_mm

inline double rad(double deg) { return deg * calib::kRadPerDegree; }

/// Uniform on the sphere.
inline Vec3d drawn_direction(std::uint64_t key) {
  return Vec3d(normal(mix(key) + 1), normal(mix(key) + 2), normal(mix(key) + 3)).normalized();
}
inline Vec3d tilted(const Vec3d& direction, double by_rad, std::uint64_t key) {
  const Vec3d axis = direction.cross(drawn_direction(key)).normalized();
  return Eigen::AngleAxisd(by_rad, axis) * direction;
}

/// Either axis tilted by up to 2 degrees, the swing axis beside the rotation axis by up to 0.3 mm, harmonics up to
/// 0.02 degrees: the bounds of the twin's drawn mounts.
inline calib::Mount drawn_mount(std::uint64_t seed) {
  const std::uint64_t key = mix(seed) ^ 0x51;
  const auto harmonic = [&](std::uint64_t k) { return rad(drawn_in(key + k, -0.02, 0.02)); };
  calib::Mount out;
  out.serial = "SYNTHETIC-" + std::to_string(seed);
  out.rotation.direction = triple(tilted(-Vec3d::UnitZ(), rad(drawn_in(key, 0.2, 2)), key + 1));
  out.rotation.point_mm = {27 + drawn_in(key + 2, -0.3, 0.3), drawn_in(key + 3, -0.3, 0.3), 48};
  out.rotation.harmonic_rad = {harmonic(4), harmonic(5)};
  out.swing.direction = triple(tilted(Vec3d::UnitY(), rad(drawn_in(key + 6, 0.2, 2)), key + 7));
  out.swing.point_mm = {27 + drawn_in(key + 8, -0.3, 0.3), 0, 48 + drawn_in(key + 9, -0.3, 0.3)};
  out.swing.harmonic_rad = {harmonic(10), harmonic(11)};
  return out;
}

inline calib::AxisAngles angles_deg(double rotation, double swing) {
  calib::AxisAngles out;
  out.rotation_command = rad(rotation), out.swing_command = rad(swing);
  return out;
}

/// What happens from stop `at` on (or at it alone).
struct Mishap {
  std::size_t at = 0;
  double rotation_deg = 0, swing_deg = 0;  ///< by which the table stands further than it says
  Pose on_table = Pose::Identity();        ///< of the model's surface before the camera …
  Pose before_camera = Pose::Identity();   ///< … and of the camera before the table
  bool once = false;
};

struct TableScene {
  static constexpr double kSigma_mm = 0.0085;  // of a pixel: the design's shot limit
  static constexpr double kAngle_deg = 0.01;   // of the drives, as the twin's scenes
  static constexpr double kRunOut_mm = 0.001;

  explicit TableScene(std::uint64_t seed) : own(mix(seed) ^ 0xAB), mount(drawn_mount(seed)), surface(seed) {}

  /// Where the camera truly is at stop k, model frame.
  [[nodiscard]] Pose truth(std::size_t k, const calib::AxisAngles& told, const Mishap& mishap) const {
    const std::uint64_t key = own + 100 * k;
    pipeline::AxesOffset off;
    off.rotation_rad = rad(kAngle_deg) * normal(key), off.swing_rad = rad(kAngle_deg) * normal(key + 1);
    off.before_camera.translation() = kRunOut_mm * Vec3d(normal(key + 2), normal(key + 3), normal(key + 4));
    if (mishap.once ? k == mishap.at : k >= mishap.at) {
      off.rotation_rad += rad(mishap.rotation_deg), off.swing_rad += rad(mishap.swing_deg);
      off.on_table = mishap.on_table;
      off.before_camera = off.before_camera * mishap.before_camera;
    }
    return pipeline::pose_by_axes(mount, told, off);
  }
  [[nodiscard]] SurfacePatch patch(const Pose& T_model_cam, std::uint64_t noise_seed) const {
    return make_patch(surface, rig.camera, T_surface_model * T_model_cam, {kSigma_mm, 0.03, own ^ noise_seed});
  }
  [[nodiscard]] pipeline::Stop stop(std::size_t k, const calib::AxisAngles& told, const Pose& T_model_cam) const {
    return pipeline::make_stop(patch(T_model_cam, k), told, pipeline::stop_viewer(rig.camera, lay), icp, lay);
  }
  [[nodiscard]] pipeline::LayingRules rules() const { return {rig.camera, icp, edge}; }

  std::uint64_t own;
  calib::Mount mount;
  SyntheticSurface surface;
  calib::Rig rig = test_rig(2);
  Pose T_surface_model = looking_down(0, 0);
  pipeline::IcpConfig icp;
  pipeline::EdgeConfig edge;
  pipeline::LayConfig lay;
};

}  // namespace enamel::testing
