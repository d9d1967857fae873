#include "host/session/bent_model.hpp"

#include <utility>

namespace enamel::host {
namespace {

constexpr float kSeenMm = 0.005F;  // as fusion's preview: a picture need not follow every micron

std::shared_ptr<const BlockMesh> moved(const BlockMesh& block, const pipeline::MapBend::Shift& shift) {
  auto out = std::make_shared<BlockMesh>(block);
  for (Vec3f& p : out->vertices) p += shift.of(p);
  return out;
}

}  // namespace

std::shared_ptr<const ModelSnapshot> BentModel::bent(const std::shared_ptr<const ModelSnapshot>& model) {
  if (!model) return model;
  auto out = std::make_shared<ModelSnapshot>(*model);
  for (std::shared_ptr<const BlockMesh>& block : out->blocks) {
    if (!block || block->vertices.empty()) continue;
    const pipeline::MapBend::Shift shift = bend_->around(block->vertices[block->vertices.size() / 2]);
    Bent& last = blocks_[block->block];
    const bool still = last.source == block && (shift.there - last.shift).norm() < kSeenMm;
    if (!still && shift.there.norm() < kSeenMm)
      last = {block, block, Vec3f::Zero()};
    else if (!still)
      last = {block, moved(*block, shift), shift.there};
    block = last.shown;
  }
  return out;
}

std::shared_ptr<const BurstPreview> BentModel::operator()(std::shared_ptr<const BurstPreview> shown) {
  if (!bend_) return shown;
  auto out = std::make_shared<BurstPreview>(*shown);
  out->T_model_return = bend_->carry(shown->T_model_return);
  if (shown->segment == kModelSegment) {
    out->T_model_cam = bend_->carry(shown->T_model_cam);
    out->model = bent(shown->model);
  } else {
    out->whole = bent(shown->whole);
  }
  return out;
}

}  // namespace enamel::host
