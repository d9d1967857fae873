#include "pipeline/register/track/near_alignment.hpp"

#include <algorithm>
#include <array>
#include <numbers>

#include "pipeline/register/icp/seconds.hpp"

namespace enamel::pipeline {
namespace {

/// The wrist rolls about the place looked at, faster than sparse bursts can foretell: small turns first.
std::array<Pose, 8> turned_about_work_point(const Pose& pose, double distance_mm, const std::array<double, 2>& angles) {
  const Vec3d work(0, 0, distance_mm);
  std::array<Pose, 8> out;
  std::size_t n = 0;
  for (const double degrees : angles) {
    for (const Vec3d& axis : {Vec3d::UnitX().eval(), Vec3d::UnitY().eval()}) {
      for (const double sign : {1.0, -1.0}) {
        const Eigen::AngleAxisd turn(sign * degrees * std::numbers::pi / 180, axis);
        out[n++] = pose * Eigen::Translation3d(work) * turn * Eigen::Translation3d(-work);
      }
    }
  }
  return out;
}

}  // namespace

std::optional<IcpResult> NearAlignment::operator()(const SegmentMemory& segment, const Burst& burst) {
  const MotionModel& motion = segment.motion;
  const Pose predicted = motion.predict(burst.t);
  const Ask ask{segment, burst, predicted};
  Starts starts;
  starts.add(predicted);
  if (const auto by_twist = motion.predict_by_twist(burst.t)) starts.add(*by_twist);
  starts.add(motion.last_pose());
  // The model first: it averages many bursts. The last patch covers what the model, two bursts behind, does not show
  // yet.
  if (!burst.view.empty && burst.view.segment == segment.id) {
    if (auto found = from(std::span(starts.poses).first(starts.count), reference_of(burst.view), ask)) return found;
  }
  for (const Pose& turned :
       turned_about_work_point(motion.last_pose(), config_.motion.work_distance_mm, config_.wrist_deg)) {
    starts.add(turned);
  }
  const ModelView last = viewer_(*segment.last_patch->patch, segment.last_patch->T_model_cam);
  return from(std::span(starts.poses).first(starts.count), Reference(last, config_.icp.reference), ask);
}

const Reference& NearAlignment::reference_of(const ModelView& view) {
  if (view.drawing == 0 || view.drawing != drawing_) reference_.draw(view, config_.icp.reference, scratch_);
  drawing_ = view.drawing;
  return reference_;
}

std::optional<IcpResult> NearAlignment::from(std::span<const Pose> starts, const Reference& reference,
                                             const Ask& ask) const {
  for (const Pose& start : starts) {
    const IcpResult result = align(ask.burst.pyramid, reference, camera_, start, ask.predicted, config_.icp);
    if (!acceptable_for(result, ask)) continue;
    return result.weak_directions == 0 ? result : held_by_texture(result, reference, ask);
  }
  return std::nullopt;
}

IcpResult NearAlignment::held_by_texture(const IcpResult& by_shape, const Reference& reference, const Ask& ask) const {
  if (!ask.segment.texture) return by_shape;
  const Vec3d centre = by_shape.T_model_cam * ask.burst.pyramid.levels.back().centroid;
  const WeakDirections weak = weak_directions(by_shape.system, config_.icp.prior.weak_eigenvalue);
  const auto hold =
      hold_by_texture({ask.burst.texture.points(), *ask.segment.texture, lens_, centre, config_.icp.rho_mm},
                      by_shape.T_model_cam, weak, config_.texture);
  if (!hold) return by_shape;
  const Pose told = apply_motion(hold->x, centre, config_.icp.rho_mm, by_shape.T_model_cam);
  IcpResult out = align(ask.burst.pyramid, reference, camera_, told, told, config_.icp);
  if (!acceptable_for(out, ask)) return by_shape;
  out.undetermined = std::max(0, out.weak_directions - hold->held);
  out.texture_moved = hold->moved;
  return out;
}

bool NearAlignment::acceptable_for(const IcpResult& result, const Ask& ask) const {
  return acceptable(result, ask.burst.pyramid.levels.back().median_sigma_mm, config_.accept) &&
         plausible(result.T_model_cam, ask);
}

bool NearAlignment::plausible(const Pose& T_model_cam, const Ask& ask) const {
  const Pose& last = ask.segment.motion.last_pose();
  const double dt = seconds(ask.segment.motion.last_time(), ask.burst.t);
  const Vec3d work(0, 0, config_.motion.work_distance_mm);
  const double shift = (T_model_cam * work - last * work).norm();
  const Eigen::AngleAxisd turn(last.linear().transpose() * T_model_cam.linear());
  const double turn_deg = turn.angle() * 180 / std::numbers::pi;
  return shift <= config_.slack_mm + config_.max_speed_mm_s * dt &&
         turn_deg <= config_.slack_deg + config_.max_turn_deg_s * dt;
}

}  // namespace enamel::pipeline
