// A calibration set of the tests' own making: a rig, poses of a dot target, and what the camera sees. Lens, light and
// sampling are written out here again, so that nothing of calib/ judges itself.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "calib/io/calib_folder.hpp"
#include "calib/solve/observation.hpp"
#include "protocol/base/rng.hpp"

namespace enamel::test {

struct CalibScene {
  calib::RigState truth;  ///< rig, poses T_cam_target, the dots' real offsets
  calib::TargetDesign target;
  calib::Rig nominal;  ///< what a design drawing says
  /// What no lens formula of calib/ describes. A wave over the projector's u, px:
  double wave_px = 0;
  /// A bow of every depth along the camera's x, as a height over 16 mm: `truth` without it would see a flat bowed.
  double bow_um = 0;
};

/// A probe as it comes from assembly: every value off its drawing by what such parts scatter, `poses` poses all over
/// the depth, tilted by up to 35 degrees, all dots in view. Depends on `seed` alone.
[[nodiscard]] CalibScene make_calib_scene(std::uint64_t seed, int poses);

/// Offsets of a real target: normal in the plane, a bow out of it (peak to valley).
void deform_target(CalibScene& scene, double in_plane_mm, double bow_mm, Rng& rng);

struct ViewNoise {
  double centre_px = 0.001;
  double projector_px = 0.004;  ///< of one sample; a disc has about a hundred here
  double ground_px = 0;         ///< of a mean over the ground between the dots; 0: no ground is measured
};

/// Dots as measure_pose would give them, without images: ellipse centres with their bias, samples of the projector's
/// coordinates.
[[nodiscard]] std::vector<calib::PoseView> make_views(const CalibScene& scene, const ViewNoise& noise, Rng& rng);

struct SensorModel {
  double gain_e_per_dn = 39.84, read_e = 5, black_dn = 4;
  int averages = 16;
  double blur_px = 0.6;
  double gamma_bow = 0.02;  ///< projector: share of full scale left over after linearisation
  double extra_noise_dn = 0;
};

/// All images of one pose; fringes of 1, 4, 16, 64 cycles.
[[nodiscard]] calib::PoseFrames render_pose(const CalibScene& scene, std::size_t pose, const SensorModel& sensor,
                                            Rng& rng);

/// Photon transfer line of an image of this sensor.
[[nodiscard]] calib::PixelNoise noise_of(const SensorModel& sensor);

/// 95th percentile and the largest distance of points over 40 to 56 mm from where they are, after the best rigid
/// motion; relative scale; the largest bow along x or y of a facing plane at 42, 48, 54 mm, over 16 mm; um.
struct RigError {
  double p95_um = 0, max_um = 0, scale_ppm = 0;
  double without_scale_p95_um = 0;  ///< after the best similarity
  double sag_um = 0;
};
[[nodiscard]] RigError rig_error(const calib::RigState& solved, const calib::RigState& truth);
[[nodiscard]] RigError rig_error(const calib::RigState& solved, const CalibScene& scene);

/// Where a solved rig puts the point that the scene's instruments see: camera coordinates, mm.
[[nodiscard]] Vec3d measured_place(const calib::RigState& solved, const CalibScene& scene, const Vec3d& point);

}  // namespace enamel::test
