// What the difference of two rigs does to geometry over the measuring volume.
#pragma once

#include <array>
#include <cstdint>

#include "calib/solve/observation.hpp"

namespace enamel::calib {

/// Bow and twist of a facing plane at one depth, as heights over 16 mm: a quadratic z = a x² + b xy + c y² over
/// |x|, |y| <= 8 mm has sag 64 a (along x), 64 c (along y) and twist 64 b.
struct PlaneShape {
  double sag_x_um = 0, sag_y_um = 0, twist_um = 0;
  /// The larger of the two sags, with its sign.
  [[nodiscard]] double sag_um() const { return std::abs(sag_x_um) > std::abs(sag_y_um) ? sag_x_um : sag_y_um; }
};

struct VolumeDifference {
  double p95_um = 0, rms_um = 0, max_um = 0;
  double scale_ppm = 0;                ///< that a similarity would add to the rigid motion
  double shape_p95_um = 0;             ///< p95 after that similarity: what the pitch has no part in
  std::array<double, 3> depth_mm{};    ///< 1/8, 1/2 and 7/8 of the range: 42, 48, 54 mm of 40…56
  std::array<PlaneShape, 3> planes{};  ///< at those depths
};

/// Pixels over the image and depths over `range` are seen by `reference`; `solved` triangulates them from (pixel, u).
/// Compared after the best rigid motion: the camera frame is a matter of definition.
[[nodiscard]] VolumeDifference compare_rigs(const RigState& solved, const RigState& reference, DepthRange range);

/// Optics of a rig file as a state without poses.
[[nodiscard]] RigState state_of(const Rig& rig);

}  // namespace enamel::calib
