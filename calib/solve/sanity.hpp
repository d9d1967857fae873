// What is wrong with a set of poses before any solving. Private to calib/solve.
#pragma once

#include "calib/solve/observation.hpp"
#include "protocol/base/result.hpp"

namespace enamel::calib {

inline constexpr std::size_t kMinPoses = 3;  // two leave one lens's centre and focal length open

/// Errors: kCalibrationPoses (fewer than kMinPoses), kTargetMirrored (projector u falls while camera u rises, against
/// the nominal rig), kCalibrationUnits (the pitch puts the target far outside the rig's depth range).
[[nodiscard]] Result<void> check_views(const std::vector<PoseView>& views, const TargetDesign& target,
                                       const Rig& nominal);

/// Error: kCalibrationPoses when no two targets are turned against each other by at least 10 degrees.
[[nodiscard]] Result<void> check_tilts(const std::vector<Pose>& poses);

/// Error: kCalibrationUnits when the pitch puts camera and projector more than 8 % nearer or farther apart than the
/// design has them: no assembly is that far off, a target of another pitch is. A design without a baseline passes.
[[nodiscard]] Result<void> check_baseline(const Pose& T_proj_cam, const TargetDesign& target, const Rig& nominal);

}  // namespace enamel::calib
