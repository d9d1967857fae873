// Registration: places each patch in the model as it was some bursts ago (delay edge), and has the model judge the
// fringe orders.
#pragma once

#include <memory>

#include "pipeline/algo/decode/burst_decoder.hpp"
#include "pipeline/algo/guide/model_guide.hpp"
#include "pipeline/algo/track/tracker.hpp"
#include "pipeline/graph/stage.hpp"
#include "pipeline/stages/items.hpp"
#include "pipeline/types/model_view.hpp"

namespace enamel::stage {

class TrackStage final : public graph::Stage {
 public:
  TrackStage(const calib::Rig& rig, const algo::TrackerConfig& track, const algo::GuideConfig& guide,
             const std::shared_ptr<const algo::BurstDecoder>& decoder);

  graph::In<Decoded> patch{*this, "patch"};
  graph::In<ModelView> model{*this, "model"};
  graph::Out<Tracked> tracked{*this, "tracked"};

  Result<void> step() override;

 private:
  /// The decoded patch itself, or a copy with the regions that the model decides and without what contradicts it.
  [[nodiscard]] std::shared_ptr<const SurfacePatch> complete(const std::shared_ptr<const Decoded>& decoded,
                                                             const ModelView& view, const Pose& T_model_cam,
                                                             OrderCheck& orders) const;

  algo::Tracker tracker_;
  algo::ModelGuide guide_;
  algo::NormalConfig normals_;
};

}  // namespace enamel::stage
