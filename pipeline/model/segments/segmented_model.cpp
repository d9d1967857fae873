#include "pipeline/model/segments/segmented_model.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace enamel::pipeline {

SegmentedModel::SegmentedModel(const calib::Rig& rig, const FuseConfig& config, Unpacker unpack, bool keep_history,
                               PatchStoreConfig store)
    : rig_(rig),
      config_(config),
      unpack_(std::move(unpack)),
      keep_history_(keep_history),
      store_(std::move(store)),
      model_(rig, config) {}

FuseStats SegmentedModel::integrate(BurstId burst, const SurfacePatch& patch, const TrackResult& placed) {
  for (const SegmentJoin& one : placed.joins) join(one);
  active_ = placed.segment;
  if (active_ == kModelSegment) {
    if (keep_history_) {
      last_kept_ = store_.keep(pack(patch, Texture::kDropped));
      history_.push_back({burst, placed.T_model_cam, last_kept_, placed.texture});
    }
    return model_.integrate(burst, patch, placed.T_model_cam);
  }
  open(active_);
  last_kept_ = store_.keep(pack(patch, Texture::kKept));
  kept_[active_].push_back({burst, placed.T_model_cam, last_kept_, placed.texture});
  return apart_->model.integrate(burst, patch, placed.T_model_cam);
}

ModelView SegmentedModel::view(const Pose& T_segment_cam, const SurfacePatch& hint) {
  const bool of_model = active_ == kModelSegment || !apart_;
  ModelView out = (of_model ? model_ : apart_->model).view(T_segment_cam, hint);
  out.segment = active_;
  return out;
}

void SegmentedModel::set_soft_below(std::uint8_t soft_below) {
  config_.soft_below = soft_below;
  model_.set_soft_below(soft_below);
  if (apart_) apart_->model.set_soft_below(soft_below);
}

void SegmentedModel::join(const SegmentJoin& join) {
  auto moved = kept_.extract(join.segment);
  if (apart_ && (apart_->id == join.segment || apart_->id == join.into)) apart_.reset();
  if (moved.empty()) return;
  for (KeptBurst& burst : moved.mapped()) burst.T_segment_cam = join.T_into_segment * burst.T_segment_cam;
  if (join.into == kModelSegment) {
    std::ranges::move(moved.mapped(), std::back_inserter(waiting_));
    return;
  }
  std::vector<KeptBurst>& into = kept_[join.into];
  std::ranges::move(moved.mapped(), std::back_inserter(into));
  std::ranges::sort(into, {}, [](const KeptBurst& b) { return b.id.value; });
}

void SegmentedModel::catch_up(std::size_t bursts) {
  for (; bursts > 0 && !waiting_.empty(); --bursts) {
    KeptBurst& next = waiting_.front();
    model_.integrate(next.id, patch_of(next, Texture::kDropped), next.T_segment_cam);
    if (keep_history_) history_.push_back(std::move(next));
    waiting_.pop_front();
  }
}

std::vector<KeptBurst> SegmentedModel::take_history() {
  for (; keep_history_ && !waiting_.empty(); waiting_.pop_front()) history_.push_back(std::move(waiting_.front()));
  std::ranges::sort(history_, {}, [](const KeptBurst& b) { return b.id.value; });
  return std::exchange(history_, {});
}

void SegmentedModel::rebuild(const std::vector<KeptBurst>& history,
                             const std::function<SurfacePatch(std::size_t)>& load) {
  model_ = TsdfModel(rig_, config_);
  for (std::size_t n = 0; n < history.size(); ++n) model_.integrate(history[n].id, load(n), history[n].T_segment_cam);
}

TsdfModel SegmentedModel::fuse_apart(SegmentId segment) const {
  TsdfModel out(rig_, config_);
  if (const auto found = kept_.find(segment); found != kept_.end()) {
    for (const KeptBurst& burst : found->second)
      out.integrate(burst.id, patch_of(burst, Texture::kDropped), burst.T_segment_cam);
  }
  return out;
}

void SegmentedModel::open(SegmentId segment) {
  if (apart_ && apart_->id == segment) return;
  apart_.emplace(Apart{segment, fuse_apart(segment)});
  ++openings_;
}

}  // namespace enamel::pipeline
