#include "pipeline/stages/track_stage.hpp"

#include <algorithm>
#include <utility>

#include "pipeline/model/guide/complete.hpp"
#include "pipeline/stages/digest.hpp"

namespace enamel::stage {

TrackStage::TrackStage(const calib::Rig& rig, const pipeline::TrackerConfig& track, const pipeline::GuideConfig& guide,
                       const std::shared_ptr<const pipeline::BurstDecoder>& decoder)
    : Stage("track"),
      tracker_(rig, track),
      guide_(decoder->shared_rays(), rig.camera, guide),
      normals_(decoder->config().normals) {}

Result<void> TrackStage::step() {
  const auto decoded = patch.take();
  const auto view = model.take();
  std::shared_ptr<const SurfacePatch> completed{decoded.value, &decoded->patch};
  shades_.add(decoded->patch.shade);
  const std::uint8_t soft_below = shades_.heaps().soft_below;
  tracker_.set_soft_below(soft_below);
  const TrackResult result = tracker_.track(decoded.id, decoded.captured, completed, *view, decoded->motion.twist);
  if (result.state == TrackState::kLost) {
    tracked.emit(flow::make_rejected<Tracked>(decoded, "too_little_surface"));
    return {};
  }
  OrderCheck orders;
  if (view->segment == result.segment) completed = complete(decoded.value, *view, result.T_model_cam, orders);
  Tracked out{std::move(completed), decoded->motion, result, orders, decoded->digests, decoded->sight, soft_below};
  out.digests.track = Digest()
                          .add(result.T_model_cam)
                          .add(result.rms_mm)
                          .add(result.overlap)
                          .add(result.segment)
                          .add(orders.checked)
                          .add(orders.contradicting)
                          .add(orders.guided_px)
                          .add(orders.withdrawn_px)
                          .value();
  tracked.emit(flow::make_item<Tracked>(decoded, std::move(out)));
  return {};
}

std::shared_ptr<const SurfacePatch> TrackStage::complete(const std::shared_ptr<const Decoded>& decoded,
                                                         const ModelView& view, const Pose& T_model_cam,
                                                         OrderCheck& orders) {
  orders = guide_.check(decoded->patch, view, T_model_cam);
  const auto told = guide_.decide(decoded->relative, view, T_model_cam, votes_);
  const bool none = std::all_of(told.begin(), told.end(), [](std::int32_t k) { return k == kOpenOrder; });
  if (none && orders.contradicting == 0) return {decoded, &decoded->patch};
  auto judged = std::make_shared<SurfacePatch>(decoded->patch);
  if (orders.contradicting > 0) orders.withdrawn_px = guide_.withdraw(view, T_model_cam, *judged);
  orders.guided_px = pipeline::add_decided(decoded->relative, told, guide_.rays(), normals_, *judged);
  return judged;
}

}  // namespace enamel::stage
