// Fusion: adds placed patches to the model, or to the segment apart that they were placed in, gives its view back to
// registration and shows the growing surface.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "pipeline/flow/stage.hpp"
#include "pipeline/model/mesh/incremental_mesher.hpp"
#include "pipeline/model/segments/segmented_model.hpp"
#include "pipeline/stages/items.hpp"
#include "pipeline/types/mesh.hpp"
#include "pipeline/types/model_view.hpp"
#include "pipeline/types/preview.hpp"
#include "pipeline/types/sight_votes.hpp"

namespace enamel::stage {

struct FuseStageConfig {
  pipeline::FuseConfig fuse;
  pipeline::MeshConfig mesh;
  bool preview_model = false;  ///< somebody watches the surface grow: mesh it as it changes
  int preview_period = 2;      ///< … every so many bursts
  bool keep_history = false;   ///< every burst is kept, packed, so that the model can be fused anew with other poses
  pipeline::PatchStoreConfig store;  ///< of kept bursts
};

/// Sees rejected bursts too: registration wants a view for every burst, and the person at the screen that one was lost.
class FuseStage final : public flow::Stage {
 public:
  FuseStage(const calib::Rig& rig, const FuseStageConfig& config, pipeline::Unpacker unpack);

  flow::In<Tracked> tracked{*this, "tracked"};
  flow::Out<Fused> fused{*this, "fused"};
  flow::Out<ModelView> view{*this, "view"};
  flow::Out<BurstPreview> preview{*this, "preview"};

  Result<void> step() override;
  [[nodiscard]] bool handles_rejected() const noexcept override { return true; }

  /// After the run: what is apart, and joins that are found then.
  [[nodiscard]] pipeline::SegmentedModel& segments() noexcept { return model_; }
  /// After the run: the model fused anew from its bursts, with the poses that they have in `history`.
  void rebuild(const std::vector<pipeline::KeptBurst>& history, const std::function<SurfacePatch(std::size_t)>& load);
  /// After the run: the newest burst before the model as it is now.
  [[nodiscard]] std::shared_ptr<const BurstPreview> final_preview();
  /// After the run: the model's surface with all its blocks welded …
  [[nodiscard]] Mesh extract_mesh();
  /// … and that of a segment that is still apart.
  [[nodiscard]] Mesh extract_apart(SegmentId segment) const;

 private:
  void pass_rejected(const flow::Item<Tracked>& item);
  /// The last view while it still shows what the probe sees, else a new one.
  void renew_view(const Pose& T_model_cam, const SurfacePatch& patch);
  [[nodiscard]] std::shared_ptr<const BurstPreview> make_preview(const flow::Item<Tracked>& item);
  [[nodiscard]] std::shared_ptr<const ModelSnapshot> growing_surface();

  FuseStageConfig config_;
  pipeline::SegmentedModel model_;
  pipeline::IncrementalMesher mesher_;
  pipeline::IncrementalMesher apart_mesher_;  ///< of the segment apart that is being scanned …
  std::uint64_t apart_meshed_ = 0;            ///< … SegmentedModel::openings() of it
  Vec3d looked_at_;                           ///< middle of the depth range, camera frame
  std::shared_ptr<const ModelView> last_view_;
  int view_served_ = 0;  ///< bursts that it was published after
  BurstPreview last_preview_;
  SightVotes sight_;
  int until_preview_ = 0;
  std::vector<float> depths_;  ///< scratch
};

}  // namespace enamel::stage
