#include "pipeline/algo/track/motion_model.hpp"

#include <algorithm>

#include "pipeline/algo/icp/normal_system.hpp"

namespace enamel::algo {
namespace {

double seconds(DeviceTime from, DeviceTime to) { return 1e-9 * static_cast<double>((to - from).count()); }

}  // namespace

void MotionModel::add(DeviceTime t, const Pose& T_model_cam) {
  count_ = std::min(count_ + 1, states_.size());
  for (std::size_t i = count_ - 1; i > 0; --i) states_[i] = states_[i - 1];
  states_[0] = {t, T_model_cam};
}

Pose MotionModel::predict(DeviceTime t) const {
  const State& last = states_[0];
  std::size_t oldest = 0;
  while (oldest + 1 < count_ && seconds(states_[oldest + 1].t, last.t) <= config_.window_s) ++oldest;
  // Sparse bursts: the two newest span more than the window, and say more than holding still does.
  if (oldest == 0 && count_ > 1 && seconds(states_[1].t, last.t) <= config_.max_span_s) oldest = 1;
  if (oldest == 0) return last.T;
  const double span = seconds(states_[oldest].t, last.t);
  const double ahead = std::min(seconds(last.t, t), std::max(config_.max_extrapolation_s, span));
  if (!(span > 0) || !(ahead > 0)) return last.T;
  const Vec3d work(0, 0, config_.work_distance_mm);
  const Vector6 moved = motion_between(states_[oldest].T, last.T, states_[oldest].T * work, 1.0);
  return apply_motion(moved * (ahead / span), last.T * work, 1.0, last.T);
}

}  // namespace enamel::algo
