// Where the hand will be: the last pose carried on with the mean velocity of the last few.
#pragma once

#include <array>
#include <cstddef>

#include "pipeline/types/geometry.hpp"
#include "protocol/base/time.hpp"

namespace enamel::algo {

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

  void add(DeviceTime t, const Pose& T_model_cam);
  /// Forgets velocities (a jump), keeps nothing.
  void clear() { count_ = 0; }

  [[nodiscard]] bool empty() const noexcept { return count_ == 0; }
  [[nodiscard]] DeviceTime last_time() const noexcept { return states_[0].t; }
  [[nodiscard]] const Pose& last_pose() const noexcept { return states_[0].T; }
  /// Precondition: !empty().
  [[nodiscard]] Pose predict(DeviceTime t) const;

 private:
  struct State {
    DeviceTime t{};
    Pose T = Pose::Identity();
  };
  MotionConfig config_;
  std::array<State, 8> states_;  ///< newest first
  std::size_t count_ = 0;
};

}  // namespace enamel::algo
