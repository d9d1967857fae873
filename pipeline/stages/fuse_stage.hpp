// Fusion: adds placed patches to the model, gives the model's view back to registration and shows the growing surface.
#pragma once

#include <memory>

#include "pipeline/algo/fuse/tsdf_model.hpp"
#include "pipeline/algo/mesh/incremental_mesher.hpp"
#include "pipeline/graph/stage.hpp"
#include "pipeline/stages/items.hpp"
#include "pipeline/stages/preview_item.hpp"
#include "pipeline/types/mesh.hpp"
#include "pipeline/types/model_view.hpp"

namespace enamel::stage {

struct FuseStageConfig {
  algo::FuseConfig fuse;
  algo::MeshConfig mesh;
  bool preview_model = false;  ///< somebody watches the surface grow: mesh it as it changes
  int preview_period = 2;      ///< … every so many bursts
};

/// Sees rejected bursts too: registration wants a view for every burst, and the person at the screen that one was lost.
class FuseStage final : public graph::Stage {
 public:
  FuseStage(const calib::Rig& rig, const FuseStageConfig& config);

  graph::In<Tracked> tracked{*this, "tracked"};
  graph::Out<Fused> fused{*this, "fused"};
  graph::Out<ModelView> view{*this, "view"};
  graph::Out<PreviewItem> preview{*this, "preview"};

  Result<void> step() override;
  [[nodiscard]] bool handles_rejected() const noexcept override { return true; }

  /// After the run: the surface with all its blocks welded.
  [[nodiscard]] Mesh extract_mesh();

 private:
  void pass_rejected(const graph::Item<Tracked>& item);
  [[nodiscard]] std::shared_ptr<const PreviewItem> make_preview(const graph::Item<Tracked>& item);

  FuseStageConfig config_;
  algo::TsdfModel model_;
  algo::IncrementalMesher mesher_;
  std::shared_ptr<const ModelView> last_view_;
  PreviewItem last_preview_;
  int until_preview_ = 0;
};

}  // namespace enamel::stage
