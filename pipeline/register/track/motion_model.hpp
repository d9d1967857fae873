// Where the hand will be: the last pose carried on with the mean of two velocities, that of the last few poses and
// that which the last burst itself shows (rigid_motion.hpp). The one smooths tremor, the other knows of a turn at once.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "pipeline/register/icp/normal_system.hpp"
#include "pipeline/types/geometry.hpp"
#include "pipeline/types/probe_motion.hpp"
#include "protocol/base/time.hpp"

namespace enamel::pipeline {

struct MotionConfig {
  double window_s = 0.12;            ///< velocity is the mean over about a period of hand tremor (8 … 12 Hz)
  double max_span_s = 0.5;           ///< with fewer than two poses in the window: over the two newest, if no older
  double max_extrapolation_s = 0.1;  ///< beyond it and the span averaged over, the hand may turn back: held there
  double work_distance_mm = 48;      ///< motion is a turn about, and a shift of, the point this far before the camera
};

/// Accepted poses only, in order of time. Deterministic.
class MotionModel {
 public:
  explicit MotionModel(const MotionConfig& config) : config_(config) {}

  void add(DeviceTime t, const Pose& T_model_cam, const std::optional<ProbeTwist>& twist = std::nullopt);
  /// The same motion in another frame.
  void carry_into(const Pose& T_other_model);

  [[nodiscard]] bool empty() const noexcept { return count_ == 0; }
  [[nodiscard]] DeviceTime last_time() const noexcept { return states_[0].t; }
  [[nodiscard]] const Pose& last_pose() const noexcept { return states_[0].T; }
  /// Precondition: !empty().
  [[nodiscard]] Pose predict(DeviceTime t) const;
  /// With the last burst's own velocity alone, where it is known. Precondition: !empty().
  [[nodiscard]] std::optional<Pose> predict_by_twist(DeviceTime t) const;

 private:
  struct State {
    DeviceTime t{};
    Pose T = Pose::Identity();
    std::optional<ProbeTwist> twist;
  };
  struct Velocity {
    Vector6 per_s = Vector6::Zero();  ///< about the last pose's work point, in the model's axes
    double reach_s = 0;               ///< for which it is carried on
  };
  [[nodiscard]] std::optional<Velocity> mean_velocity() const;
  [[nodiscard]] std::optional<Velocity> own_velocity() const;
  [[nodiscard]] Pose carry_on(const Velocity& velocity, DeviceTime t) const;

  MotionConfig config_;
  std::array<State, 8> states_;  ///< newest first
  std::size_t count_ = 0;
};

}  // namespace enamel::pipeline
