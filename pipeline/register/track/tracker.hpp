// Places each burst in the model: predict, align to the model's view, fall back to the last patch, else find it again.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "calib/model/rig.hpp"
#include "pipeline/register/icp/icp.hpp"
#include "pipeline/register/track/acceptance.hpp"
#include "pipeline/register/track/keyframes.hpp"
#include "pipeline/register/track/motion_model.hpp"
#include "pipeline/register/track/relocalise.hpp"
#include "pipeline/types/model_view.hpp"
#include "pipeline/types/patch.hpp"
#include "pipeline/types/track.hpp"
#include "protocol/base/ids.hpp"
#include "protocol/base/time.hpp"

namespace enamel::pipeline {

struct TrackerConfig {
  IcpConfig icp;
  AcceptConfig accept;
  FeatureConfig features;
  KeyframeConfig keyframes;
  RelocaliseConfig relocalise;
  MotionConfig motion;
  double start_coverage = 0.05;  ///< share of the image's grid that must be good surface to define the model
  double max_gap_s = 0.5;       ///< of data time without a burst, or without a placed one: found again by features only
  double max_speed_mm_s = 200;  ///< of the point at the working distance: no hand is faster, an alignment may be
  double max_turn_deg_s = 360;
  double slack_mm = 0.5;  ///< added to what the speed limits allow
  double slack_deg = 3;
  std::array<double, 2> wrist_deg{12, 24};  ///< turns tried about the place looked at where no other start converges
};

/// One burst after the other, in order of burst; single-threaded. Results are a function of the sequence of arguments
/// only. A patch whose result is kLost must not be fused. The model frame is that of the first patch placed and never
/// changes.
class Tracker {
 public:
  Tracker(const calib::Rig& rig, const TrackerConfig& config);

  /// view: the model as it was some bursts ago, drawn from any recent pose, or empty. t_mid: data time of mid-burst.
  /// twist: what the burst itself shows of the probe's velocity; a prior for the bursts to come.
  [[nodiscard]] TrackResult track(BurstId burst, DeviceTime t_mid, const SurfacePatch& patch, const ModelView& view,
                                  const std::optional<ProbeTwist>& twist = std::nullopt);

  [[nodiscard]] const std::vector<Keyframe>& keyframes() const noexcept { return keyframes_.all(); }

 private:
  [[nodiscard]] std::optional<IcpResult> align_near(const PatchPyramid& pyramid, const ModelView& view,
                                                    DeviceTime t) const;
  /// From one start after the other; the first that may be believed.
  [[nodiscard]] std::optional<IcpResult> align_from(std::span<const Pose> starts, const PatchPyramid& pyramid,
                                                    const ModelView& source, const Pose& predicted, DeviceTime t) const;
  [[nodiscard]] std::optional<IcpResult> find_again(BurstId burst, const SurfacePatch& patch,
                                                    const PatchPyramid& pyramid, const ModelView& view);
  [[nodiscard]] bool plausible(const Pose& T_model_cam, DeviceTime t) const;
  [[nodiscard]] TrackResult accept(TrackState state, DeviceTime t, const SurfacePatch& patch, const IcpResult& icp,
                                   const std::optional<ProbeTwist>& twist);
  [[nodiscard]] TrackResult lost() const;

  TrackerConfig config_;
  calib::LensValues lens_;
  ViewCamera camera_;
  double px_per_mm_ = 1;
  std::size_t grid_size_ = 0;  ///< samples of a full image at the finest level
  MotionModel motion_;
  KeyframeStore keyframes_;
  std::optional<ModelView> last_patch_;  ///< of the last placed burst
  std::optional<DeviceTime> last_seen_;  ///< of the last burst handed in
  std::uint64_t searches_ = 0;
};

}  // namespace enamel::pipeline
