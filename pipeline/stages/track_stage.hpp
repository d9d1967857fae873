// Registration: places each patch in the model as it was some bursts ago (delay edge).
#pragma once

#include "pipeline/algo/track/tracker.hpp"
#include "pipeline/graph/stage.hpp"
#include "pipeline/stages/digest.hpp"
#include "pipeline/stages/items.hpp"
#include "pipeline/types/model_view.hpp"

namespace enamel::stage {

class TrackStage final : public graph::Stage {
 public:
  TrackStage(const calib::Rig& rig, const algo::TrackerConfig& config) : Stage("track"), tracker_(rig, config) {}

  graph::In<Decoded> patch{*this, "patch"};
  graph::In<ModelView> model{*this, "model"};
  graph::Out<Tracked> tracked{*this, "tracked"};

  Result<void> step() override {
    const auto decoded = patch.take();
    const auto view = model.take();
    const TrackResult result =
        tracker_.track(decoded.id, decoded.captured, decoded->patch, *view, decoded->motion.twist);
    if (result.state == TrackState::kLost) {
      tracked.emit(graph::make_rejected<Tracked>(decoded, "lost_track"));
      return {};
    }
    Digests digests = decoded->digests;
    digests.track = Digest().add(result.T_model_cam).add(result.rms_mm).add(result.overlap).value();
    tracked.emit(graph::make_item<Tracked>(decoded, Tracked{decoded.value, result, digests}));
    return {};
  }

 private:
  algo::Tracker tracker_;
};

}  // namespace enamel::stage
