#include "pipeline/register/track/motion_model.hpp"

#include <algorithm>

#include "pipeline/register/icp/normal_system.hpp"
#include "pipeline/register/icp/seconds.hpp"

namespace enamel::pipeline {
void MotionModel::add(DeviceTime t, const Pose& T_model_cam, const std::optional<ProbeTwist>& twist) {
  count_ = std::min(count_ + 1, states_.size());
  for (std::size_t i = count_ - 1; i > 0; --i) states_[i] = states_[i - 1];
  states_[0] = {t, T_model_cam, twist};
}

void MotionModel::carry_into(const Pose& T_other_model) {
  for (std::size_t i = 0; i < count_; ++i) states_[i].T = T_other_model * states_[i].T;
}

std::optional<MotionModel::Velocity> MotionModel::mean_velocity() const {
  const State& last = states_[0];
  std::size_t oldest = 0;
  while (oldest + 1 < count_ && seconds(states_[oldest + 1].t, last.t) <= config_.window_s) ++oldest;
  // Sparse bursts: the two newest span more than the window, and say more than holding still does.
  if (oldest == 0 && count_ > 1 && seconds(states_[1].t, last.t) <= config_.max_span_s) oldest = 1;
  const double span = seconds(states_[oldest].t, last.t);
  if (oldest == 0 || !(span > 0)) return std::nullopt;
  const Vec3d work(0, 0, config_.work_distance_mm);
  const Vector6 moved = motion_between(states_[oldest].T, last.T, states_[oldest].T * work, 1.0);
  return Velocity{moved / span, std::max(config_.max_extrapolation_s, span)};
}

std::optional<MotionModel::Velocity> MotionModel::own_velocity() const {
  const State& last = states_[0];
  if (!last.twist) return std::nullopt;
  const auto R = last.T.linear();
  const Vec3d turn = R * last.twist->turn_rad_s;
  const Vec3d lever = R * Vec3d(0, 0, config_.work_distance_mm - last.twist->about_mm);
  Velocity out{Vector6::Zero(), config_.max_extrapolation_s};
  out.per_s << turn, R * last.twist->shift_mm_s + turn.cross(lever);
  return out;
}

Pose MotionModel::carry_on(const Velocity& velocity, DeviceTime t) const {
  const State& last = states_[0];
  const double ahead = std::min(seconds(last.t, t), velocity.reach_s);
  if (!(ahead > 0)) return last.T;
  return apply_motion(velocity.per_s * ahead, last.T * Vec3d(0, 0, config_.work_distance_mm), 1.0, last.T);
}

Pose MotionModel::predict(DeviceTime t) const {
  const auto mean = mean_velocity(), own = own_velocity();
  if (!mean && !own) return states_[0].T;
  if (!mean || !own) return carry_on(mean ? *mean : *own, t);
  return carry_on({0.5 * (mean->per_s + own->per_s), mean->reach_s}, t);
}

std::optional<Pose> MotionModel::predict_by_twist(DeviceTime t) const {
  const auto own = own_velocity();
  if (!own) return std::nullopt;
  return carry_on(*own, t);
}

}  // namespace enamel::pipeline
