#include "pipeline/model/segments/segmented_model.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace enamel::pipeline {

SegmentedModel::SegmentedModel(const calib::Rig& rig, const FuseConfig& config, Unpacker unpack)
    : rig_(rig), config_(config), unpack_(std::move(unpack)), model_(rig, config) {}

FuseStats SegmentedModel::integrate(BurstId burst, const SurfacePatch& patch, const TrackResult& placed) {
  for (const SegmentJoin& one : placed.joins) join(one);
  active_ = placed.segment;
  if (active_ == kModelSegment) return model_.integrate(burst, patch, placed.T_model_cam);
  open(active_);
  kept_[active_].push_back({burst, placed.T_model_cam, pack(patch)});
  return apart_->model.integrate(burst, patch, placed.T_model_cam);
}

ModelView SegmentedModel::view(const Pose& T_segment_cam, const SurfacePatch& hint) const {
  const bool of_model = active_ == kModelSegment || !apart_;
  ModelView out = (of_model ? model_ : apart_->model).view(T_segment_cam, hint);
  out.segment = active_;
  return out;
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
    const KeptBurst& next = waiting_.front();
    model_.integrate(next.id, unpack_(next.patch), next.T_segment_cam);
    waiting_.pop_front();
  }
}

TsdfModel SegmentedModel::fuse_apart(SegmentId segment) const {
  TsdfModel out(rig_, config_);
  if (const auto found = kept_.find(segment); found != kept_.end()) {
    for (const KeptBurst& burst : found->second) out.integrate(burst.id, unpack_(burst.patch), burst.T_segment_cam);
  }
  return out;
}

void SegmentedModel::open(SegmentId segment) {
  if (apart_ && apart_->id == segment) return;
  apart_.emplace(Apart{segment, fuse_apart(segment)});
  ++openings_;
}

}  // namespace enamel::pipeline
