#include "pipeline/stages/fuse_stage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "pipeline/model/fuse/view_keeping.hpp"
#include "pipeline/stages/digest.hpp"
#include "pipeline/stages/live_image.hpp"

namespace enamel::stage {

namespace {

// A preview need not follow every micron, nor catch up at once.
constexpr double kVisibleMoveMm = 0.005;
constexpr std::size_t kBlocksAtOnce = 250;
// Bursts of a joined segment that are fused beside each that follows: a segment of a second is there within half of
// one.
constexpr std::size_t kCatchUp = 2;
constexpr std::size_t kAll = ~std::size_t{0};

// Median of every 64th pixel: for a distance bar. some: scratch.
double median_depth(const Map<float>& depth, std::vector<float>& some) {
  some.clear();
  for (std::size_t i = 0; i < depth.size(); i += 64) {
    if (!std::isnan(depth[i])) some.push_back(depth[i]);
  }
  if (some.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = some.begin() + static_cast<std::ptrdiff_t>(some.size() / 2);
  std::nth_element(some.begin(), middle, some.end());
  return static_cast<double>(*middle);
}

}  // namespace

FuseStage::FuseStage(const calib::Rig& rig, const FuseStageConfig& config, pipeline::Unpacker unpack)
    : Stage("fuse"),
      config_(config),
      model_(rig, config.fuse, std::move(unpack), config.keep_history, config.store),
      mesher_(config.mesh),
      apart_mesher_(config.mesh),
      looked_at_(0, 0, calib::middle_depth_mm(rig)),
      last_view_(std::make_shared<const ModelView>()) {}

Result<void> FuseStage::step() {
  const auto item = tracked.take();
  if (!item.ok()) {
    pass_rejected(item);
    return {};
  }
  const SurfacePatch& patch = *item->patch;
  const Pose& T_model_cam = item->result.T_model_cam;
  model_.set_soft_below(item->soft_below);
  const pipeline::FuseStats stats = model_.integrate(item.id, patch, item->result);
  model_.catch_up(kCatchUp);
  renew_view(T_model_cam, patch);

  Fused out{item->result, item->orders, item->motion, item->digests, item->sight, model_.last_kept(), item->soft_below};
  out.digests.fuse = Digest()
                         .add(stats.surfels_used)
                         .add(stats.voxels_updated)
                         .add(stats.blocks_new)
                         .add(last_view_->drawing)
                         .add(last_view_->points)
                         .add(last_view_->normals)
                         .value();
  fused.emit(flow::make_item<Fused>(item, std::move(out)));
  view.emit(flow::make_item<ModelView>(item, last_view_));
  preview.emit(flow::make_item<BurstPreview>(item, make_preview(item)));
  return {};
}

void FuseStage::renew_view(const Pose& T_model_cam, const SurfacePatch& patch) {
  if (still_shows(*last_view_, view_served_, model_.active(), T_model_cam, looked_at_, config_.fuse)) {
    ++view_served_;
    return;
  }
  ModelView drawn = model_.view(T_model_cam, patch);
  drawn.drawing = last_view_->drawing + 1;
  last_view_ = std::make_shared<const ModelView>(std::move(drawn));
  view_served_ = 1;
}

void FuseStage::pass_rejected(const flow::Item<Tracked>& item) {
  flow::ItemHead head = item;
  fused.emit(flow::make_rejected<Fused>(head, head.rejected));
  head.rejected = nullptr;
  view.emit(flow::make_item<ModelView>(head, last_view_));
  last_preview_.burst = item.id;
  last_preview_.placed = true;
  last_preview_.track = TrackState::kLost;
  last_preview_.rejected = item.rejected;
  preview.emit(flow::make_item<BurstPreview>(head, last_preview_));
}

std::shared_ptr<const BurstPreview> FuseStage::make_preview(const flow::Item<Tracked>& item) {
  last_preview_.burst = item.id;
  last_preview_.placed = true;
  last_preview_.track = item->result.state;
  last_preview_.track_overlap = item->result.overlap;
  last_preview_.T_model_cam = item->result.T_model_cam;
  last_preview_.segment = item->result.segment;
  last_preview_.undetermined = item->result.undetermined > 0;
  last_preview_.rejected.clear();
  last_preview_.sight = sight_.add(item->sight);
  if (item->result.segment == kModelSegment) {
    last_preview_.whole = nullptr;
    last_preview_.T_model_return = item->result.T_model_cam;
  } else if (!last_preview_.whole) {
    last_preview_.whole = std::make_shared<const ModelSnapshot>(mesher_.snapshot());
  }
  const SurfacePatch& patch = *item->patch;
  last_preview_.surface_distance_mm = median_depth(patch.depth_mm, depths_);
  last_preview_.live = std::make_shared<const Map<std::uint8_t>>(live_image(patch.texture_dn));
  if (config_.preview_model && until_preview_-- == 0) {
    until_preview_ = config_.preview_period - 1;
    last_preview_.model = growing_surface();
  }
  return std::make_shared<const BurstPreview>(last_preview_);
}

std::shared_ptr<const ModelSnapshot> FuseStage::growing_surface() {
  pipeline::TsdfModel* const apart = model_.active() == kModelSegment ? nullptr : model_.apart();
  if (apart == nullptr) {
    mesher_.update(model_.model(), model_.model().take_changed(kVisibleMoveMm), kBlocksAtOnce);
    return std::make_shared<const ModelSnapshot>(mesher_.snapshot());
  }
  if (apart_meshed_ != model_.openings()) apart_mesher_ = pipeline::IncrementalMesher(config_.mesh);
  apart_meshed_ = model_.openings();
  apart_mesher_.update(*apart, apart->take_changed(kVisibleMoveMm), kBlocksAtOnce);
  return std::make_shared<const ModelSnapshot>(apart_mesher_.snapshot());
}

void FuseStage::rebuild(const std::vector<pipeline::KeptBurst>& history,
                        const std::function<SurfacePatch(std::size_t)>& load) {
  model_.rebuild(history, load);
  mesher_ = pipeline::IncrementalMesher(config_.mesh);
}

std::shared_ptr<const BurstPreview> FuseStage::final_preview() {
  model_.catch_up(kAll);
  mesher_.update(model_.model(), model_.model().take_changed());
  last_preview_.model = std::make_shared<const ModelSnapshot>(mesher_.snapshot());
  last_preview_.whole = nullptr;
  last_preview_.segment = kModelSegment;
  last_preview_.T_model_cam = last_preview_.T_model_return;
  return std::make_shared<const BurstPreview>(last_preview_);
}

Mesh FuseStage::extract_mesh() {
  model_.catch_up(kAll);
  mesher_.update(model_.model(), model_.model().take_changed());
  return mesher_.extract();
}

Mesh FuseStage::extract_apart(SegmentId segment) const {
  pipeline::TsdfModel model = model_.fuse_apart(segment);
  pipeline::IncrementalMesher mesher(config_.mesh);
  mesher.update(model, model.take_changed());
  return mesher.extract();
}

}  // namespace enamel::stage
