// Poses carried from what registration measures to the instant that they are named after. A burst's depth and so its
// pose is the mean over four exposures. Where the hand accelerates (tremor: 8 to 12 Hz, 0.2 m/s^2), that mean is not
// the pose at mid-burst t: for T(t + s) = T(t) exp(c1 s + c2 s^2) it is T(t) exp(c2 <s^2>), about 2 um away. Fusion
// wants the mean, for its depth is the same mean; whoever compares poses with a clock wants mid-burst.
#pragma once

#include <span>
#include <vector>

#include "pipeline/types/geometry.hpp"
#include "pipeline/types/probe_motion.hpp"
#include "protocol/base/time.hpp"

namespace enamel::pipeline {

struct MeasuredPose {
  DeviceTime t_mid{};
  Pose T_model_cam = Pose::Identity();
  BurstMotion motion;
};

struct MidBurstConfig {
  double max_gap_s = 0.05;       ///< neighbours further away say nothing: tremor has turned round by then
  double work_distance_mm = 48;  ///< motion is taken as a turn about, and a shift of, the point this far ahead
};

/// c2 is that of the polynomial through the poses of the neighbours before and after and through the velocities that
/// the three bursts show. A pose without both neighbours within max_gap_s stays: from one side c2 would be a guess.
/// `poses`: in order of time.
[[nodiscard]] std::vector<Pose> poses_at_mid_burst(std::span<const MeasuredPose> poses, const MidBurstConfig& config);

}  // namespace enamel::pipeline
