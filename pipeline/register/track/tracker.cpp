#include "pipeline/register/track/tracker.hpp"

#include <algorithm>
#include <array>
#include <numbers>
#include <utility>
#include <vector>

#include "pipeline/register/track/seconds.hpp"

namespace enamel::pipeline {
namespace {

double middle_depth(const calib::Rig& rig, double fallback_mm) {
  return rig.depth_range ? 0.5 * (rig.depth_range->near_mm + rig.depth_range->far_mm) : fallback_mm;
}

TrackerConfig with_work_distance(TrackerConfig config, double distance_mm) {
  config.motion.work_distance_mm = distance_mm;
  config.keyframes.work_distance_mm = distance_mm;
  config.relocalise.work_distance_mm = distance_mm;
  return config;
}

std::size_t full_grid(const calib::LensValues& camera, int stride) {
  return static_cast<std::size_t>(camera.width / stride) * static_cast<std::size_t>(camera.height / stride);
}

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

Tracker::Tracker(const calib::Rig& rig, const TrackerConfig& config)
    : config_(with_work_distance(config, middle_depth(rig, config.motion.work_distance_mm))),
      lens_(rig.camera),
      camera_(rig.camera),
      px_per_mm_(rig.camera.fx / config_.motion.work_distance_mm),
      grid_size_(full_grid(rig.camera, config.icp.levels.back().stride_px)),
      motion_(config_.motion),
      keyframes_(rig.camera, config_.keyframes) {}

TrackResult Tracker::track(BurstId burst, DeviceTime t_mid, const SurfacePatch& patch, const ModelView& view,
                           const std::optional<ProbeTwist>& twist) {
  const bool in_sequence = last_seen_ && t_mid > *last_seen_ && seconds(*last_seen_, t_mid) <= config_.max_gap_s;
  last_seen_ = t_mid;
  const PatchPyramid pyramid = make_pyramid(patch, config_.icp);
  const auto samples = static_cast<double>(pyramid.levels.back().size());
  if (samples < config_.start_coverage * static_cast<double>(grid_size_)) return lost();
  if (motion_.empty()) {
    IcpResult first;
    first.overlap = 1;
    return accept(TrackState::kStarted, t_mid, patch, first, twist);
  }
  if (in_sequence && seconds(motion_.last_time(), t_mid) <= config_.max_gap_s) {
    if (const auto near = align_near(pyramid, view, t_mid))
      return accept(TrackState::kTracking, t_mid, patch, *near, twist);
  }
  if (const auto found = find_again(burst, patch, pyramid, view)) {
    motion_.clear();
    return accept(TrackState::kRelocalised, t_mid, patch, *found, twist);
  }
  return lost();
}

std::optional<IcpResult> Tracker::align_near(const PatchPyramid& pyramid, const ModelView& view, DeviceTime t) const {
  const Pose predicted = motion_.predict(t);
  // The model first: it averages many bursts. The last patch covers what the model, two bursts behind, does not show
  // yet.
  std::vector<Pose> starts{predicted, motion_.last_pose()};
  if (const auto by_twist = motion_.predict_by_twist(t)) starts.insert(starts.begin() + 1, *by_twist);
  if (auto found = align_from(starts, pyramid, view, predicted, t)) return found;
  for (const Pose& turned :
       turned_about_work_point(motion_.last_pose(), config_.motion.work_distance_mm, config_.wrist_deg)) {
    starts.push_back(turned);
  }
  return align_from(starts, pyramid, *last_patch_, predicted, t);
}

std::optional<IcpResult> Tracker::align_from(std::span<const Pose> starts, const PatchPyramid& pyramid,
                                             const ModelView& source, const Pose& predicted, DeviceTime t) const {
  if (source.empty) return std::nullopt;
  const Reference reference(source, config_.icp.reference);
  for (const Pose& start : starts) {
    const IcpResult result = align(pyramid, reference, camera_, start, predicted, config_.icp);
    if (acceptable(result, pyramid.levels.back().median_sigma_mm, config_.accept) && plausible(result.T_model_cam, t)) {
      return result;
    }
  }
  return std::nullopt;
}

std::optional<IcpResult> Tracker::find_again(BurstId burst, const SurfacePatch& patch, const PatchPyramid& pyramid,
                                             const ModelView& view) {
  const auto features = extract_features(patch, px_per_mm_, config_.features);
  const auto candidates = keyframes_.candidates(motion_.last_pose(), searches_++);
  const auto found = relocalise({features, pyramid, burst.value}, {keyframes_.all(), candidates}, camera_,
                                config_.features.ratio, config_.icp, config_.relocalise);
  if (!found) return std::nullopt;
  if (view.empty) return found->icp;
  // The fused model is the better reference where it shows this place.
  const Reference reference(view, config_.icp.reference);
  const Pose& start = found->icp.T_model_cam;
  const IcpResult refined = align(pyramid, reference, camera_, start, start, config_.icp);
  return acceptable(refined, pyramid.levels.back().median_sigma_mm, config_.accept) ? refined : found->icp;
}

bool Tracker::plausible(const Pose& T_model_cam, DeviceTime t) const {
  const double dt = seconds(motion_.last_time(), t);
  const Vec3d work(0, 0, config_.motion.work_distance_mm);
  const double shift = (T_model_cam * work - motion_.last_pose() * work).norm();
  const Eigen::AngleAxisd turn(motion_.last_pose().linear().transpose() * T_model_cam.linear());
  const double turn_deg = turn.angle() * 180 / std::numbers::pi;
  return shift <= config_.slack_mm + config_.max_speed_mm_s * dt &&
         turn_deg <= config_.slack_deg + config_.max_turn_deg_s * dt;
}

TrackResult Tracker::accept(TrackState state, DeviceTime t, const SurfacePatch& patch, const IcpResult& icp,
                            const std::optional<ProbeTwist>& twist) {
  motion_.add(t, icp.T_model_cam, twist);
  last_patch_ = view_from_patch(patch, icp.T_model_cam, lens_, config_.keyframes.view_stride);
  if (keyframes_.wants(icp.T_model_cam)) {
    keyframes_.add(patch, icp.T_model_cam, extract_features(patch, px_per_mm_, config_.features));
  }
  return {state, icp.T_model_cam, icp.rms_mm, icp.overlap, icp.iterations};
}

TrackResult Tracker::lost() const {
  TrackResult out;
  if (!motion_.empty()) out.T_model_cam = motion_.last_pose();
  return out;
}

}  // namespace enamel::pipeline
