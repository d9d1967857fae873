// Registration: places each patch in the model as it was some bursts ago (delay edge), and has the model judge the
// fringe orders.
#pragma once

#include <memory>

#include "pipeline/decode/burst_decoder.hpp"
#include "pipeline/flow/stage.hpp"
#include "pipeline/model/guide/model_guide.hpp"
#include "pipeline/register/track/tracker.hpp"
#include "pipeline/stages/items.hpp"
#include "pipeline/tissue/shade_limit.hpp"
#include "pipeline/types/model_view.hpp"

namespace enamel::stage {

class TrackStage final : public flow::Stage {
 public:
  TrackStage(const calib::Rig& rig, const pipeline::TrackerConfig& track, const pipeline::GuideConfig& guide,
             const std::shared_ptr<const pipeline::BurstDecoder>& decoder);

  flow::In<Decoded> patch{*this, "patch"};
  flow::In<ModelView> model{*this, "model"};
  flow::Out<Tracked> tracked{*this, "tracked"};

  Result<void> step() override;

  /// After the run: seeks the place of a burst that is still apart.
  [[nodiscard]] std::optional<SegmentJoin> seek(const pipeline::PlacedBurst& burst, const SurfacePatch& patch_of) {
    return tracker_.seek(burst, patch_of);
  }
  /// After the run: what parts teeth from soft tissue, by all its bursts.
  [[nodiscard]] pipeline::ShadeHeaps shades() const noexcept { return shades_.heaps(); }
  /// After that: frees what registration remembers of the scan.
  void forget() { tracker_.forget(); }

 private:
  /// The decoded patch itself, or a copy with the regions that the model decides and without what contradicts it.
  [[nodiscard]] std::shared_ptr<const SurfacePatch> complete(const std::shared_ptr<const Decoded>& decoded,
                                                             const ModelView& view, const Pose& T_model_cam,
                                                             OrderCheck& orders);

  pipeline::Tracker tracker_;
  pipeline::ShadeLimit shades_;
  pipeline::ModelGuide guide_;
  pipeline::GuideVotes votes_;
  pipeline::NormalConfig normals_;
};

}  // namespace enamel::stage
