#include "pipeline/register/track/tracker.hpp"

#include <algorithm>
#include <numbers>
#include <utility>

#include "pipeline/register/icp/seconds.hpp"
#include "pipeline/types/viewpoint.hpp"

namespace enamel::pipeline {
namespace {

TrackerConfig with_work_distance(TrackerConfig config, double distance_mm) {
  config.motion.work_distance_mm = distance_mm;
  config.keyframes.work_distance_mm = distance_mm;
  config.relocalise.work_distance_mm = distance_mm;
  config.relocalise.features = config.features;
  config.keyframes.features = config.features;
  return config;
}

std::size_t full_grid(const calib::LensValues& camera, int stride) {
  return static_cast<std::size_t>(camera.width / stride) * static_cast<std::size_t>(camera.height / stride);
}

IcpResult as_it_lies() {
  IcpResult out;
  out.overlap = 1;
  return out;
}

}  // namespace

struct Tracker::Burst {
  BurstId id;
  DeviceTime t;
  bool in_sequence;  ///< a moment after the last one
  const std::shared_ptr<const SurfacePatch>& patch;
  const PatchPyramid& pyramid;
  BurstTexture& texture;
  const ModelView& view;
  const std::optional<ProbeTwist>& twist;
  [[nodiscard]] NearAlignment::Burst near() const { return {pyramid, texture, view, t}; }
};

Tracker::Tracker(const calib::Rig& rig, const TrackerConfig& config)
    : config_(with_work_distance(config, calib::middle_depth_mm(rig, config.motion.work_distance_mm))),
      lens_(rig.camera),
      texture_{config_.surface_texture, config_.texture, rig.camera.fx / config_.motion.work_distance_mm,
               FringePhase(rig)},
      grid_size_(full_grid(rig.camera, config.icp.levels.back().stride_px)),
      viewer_(lens_, lens_.width, lens_.height, config_.keyframes.view_stride),
      near_(config_, lens_, viewer_),
      votes_(config_.join) {}

TrackResult Tracker::track(BurstId id, DeviceTime t_mid, const std::shared_ptr<const SurfacePatch>& patch,
                           const ModelView& view, const std::optional<ProbeTwist>& twist) {
  const bool in_sequence = last_seen_ && t_mid > *last_seen_ && seconds(*last_seen_, t_mid) <= config_.max_gap_s;
  last_seen_ = t_mid;
  make_pyramid(*patch, config_.icp, pyramid_);
  BurstTexture texture(*patch, texture_);
  const Burst burst{id, t_mid, in_sequence, patch, pyramid_, texture, view, twist};
  if (static_cast<double>(pyramid_.levels.back().offered) < config_.start_coverage * static_cast<double>(grid_size_)) {
    TrackResult lost;
    if (!segments_.empty()) lost.T_model_cam = find(active_).motion.last_pose();
    lost.segment = active_;
    return lost;
  }
  if (segments_.empty()) return accept(start(burst), TrackState::kStarted, burst, as_it_lies());
  std::optional<IcpResult> here;
  if (SegmentMemory& active = find(active_); was_here(active, burst)) here = near_(active, burst.near());
  if (here && active_ == kModelSegment) return accept(find(active_), TrackState::kTracking, burst, *here);
  if (auto back = back_in_an_older(burst, here)) return *back;
  TrackResult out = here ? accept(find(active_), TrackState::kTracking, burst, *here)
                         : accept(start(burst), TrackState::kStarted, burst, as_it_lies());
  if (const auto join = vote({id, out.segment, out.T_model_cam}, *patch, pyramid_)) {
    out.state = TrackState::kRelocalised;
    out.segment = join->into;
    out.T_model_cam = join->T_into_segment * out.T_model_cam;
    out.joins.push_back(*join);
  }
  return out;
}

std::optional<SegmentJoin> Tracker::seek(const PlacedBurst& burst, const SurfacePatch& patch) {
  return vote(burst, patch, make_pyramid(patch, config_.icp));
}

bool Tracker::was_here(const SegmentMemory& segment, const Burst& burst) const {
  const double since = seconds(segment.motion.last_time(), burst.t);
  return segment.last_patch && burst.in_sequence && since >= 0 && since <= config_.max_gap_s;
}

std::optional<TrackResult> Tracker::back_in_an_older(const Burst& burst, const std::optional<IcpResult>& here) {
  for (SegmentMemory& older : segments_) {
    if (older.id >= active_) break;
    if (!was_here(older, burst)) continue;
    const auto there = near_(older, burst.near());
    if (!there) continue;
    if (!here) {
      active_ = older.id;
      return accept(older, TrackState::kTracking, burst, *there);
    }
    const PlacedBurst placed{burst.id, active_, here->T_model_cam};
    const auto join = believe(placed, older.id, there->T_model_cam);
    if (!join) return accept(find(active_), TrackState::kTracking, burst, *here);
    TrackResult out = accept(find(join->into), TrackState::kRelocalised, burst, *there);
    out.joins.push_back(*join);
    return out;
  }
  return std::nullopt;
}

std::optional<SegmentJoin> Tracker::vote(const PlacedBurst& placed, const SurfacePatch& patch,
                                         const PatchPyramid& pyramid) {
  const std::uint64_t turn = searches_++;
  std::vector<SegmentId> ids;
  for (const SegmentMemory& older : segments_) {
    if (older.id < placed.segment) ids.push_back(older.id);
  }
  for (const SegmentId id : segments_to_ask(ids, turn, config_.join.asked)) {
    SegmentMemory& older = find(id);
    const auto found = relocalise({patch, pyramid, placed.id.value}, {older.keyframes, older.motion.last_pose(), turn},
                                  lens_, config_.icp, config_.relocalise);
    if (!found) continue;
    return believe(placed, older.id, found->icp.T_model_cam);
  }
  return std::nullopt;
}

std::optional<SegmentJoin> Tracker::believe(const PlacedBurst& placed, SegmentId into, const Pose& T_into_cam) {
  const Pose T_into_segment = T_into_cam * placed.T_segment_cam.inverse();
  const Vec3d looked_at = placed.T_segment_cam * Vec3d(0, 0, config_.motion.work_distance_mm);
  auto join = votes_.add({placed.id, {placed.segment, into, T_into_segment}, looked_at});
  if (join) carry_out(*join);
  return join;
}

void Tracker::carry_out(const SegmentJoin& join) {
  const auto from = std::ranges::find(segments_, join.segment, &SegmentMemory::id);
  if (from != segments_.end()) {
    find(join.into).absorb(std::move(*from), join.T_into_segment, active_ == join.segment);
    segments_.erase(from);
  }
  votes_.forget(join.segment);
  if (active_ == join.segment) active_ = join.into;
}

SegmentMemory& Tracker::start(const Burst& burst) {
  for (SegmentMemory& left : segments_) {
    if (!was_here(left, burst)) left.last_patch.reset();
  }
  forget_the_smallest();
  segments_.push_back({next_id_, MotionModel(config_.motion), KeyframeStore(lens_, config_.keyframes), {}, {}});
  active_ = next_id_++;
  return segments_.back();
}

void Tracker::forget_the_smallest() {
  const auto size = [](const SegmentMemory& segment) { return segment.keyframes.all().size(); };
  for (;;) {
    std::size_t remembered = 0;
    auto smallest = segments_.end();
    for (auto s = segments_.begin(); s != segments_.end(); ++s) {
      if (s->id == kModelSegment) continue;
      remembered += size(*s);
      if (smallest == segments_.end() || size(*s) < size(*smallest)) smallest = s;
    }
    if (smallest == segments_.end() || remembered < config_.max_apart_keyframes) return;
    if (smallest->id == active_) active_ = kModelSegment;
    votes_.forget(smallest->id);
    segments_.erase(smallest);
  }
}

SegmentMemory& Tracker::find(SegmentId id) { return *std::ranges::find(segments_, id, &SegmentMemory::id); }

void Tracker::remember_texture(SegmentMemory& segment, const Burst& burst, const IcpResult& icp) const {
  const Pose& T_model_cam = icp.T_model_cam;
  const Vec3d work(0, 0, config_.motion.work_distance_mm);
  const Closeness same{config_.texture_spacing_mm, config_.texture_spacing_deg};
  // What moved between two pictures is in both of them.
  if (segment.texture && icp.texture_moved) segment.texture->of_surface = true;
  if (segment.texture && look_alike(segment.texture->T_model_cam, T_model_cam, work, same)) return;
  segment.texture = burst.texture.reference();
  segment.texture->T_model_cam = T_model_cam;
  segment.texture->of_surface = icp.texture_moved;
}

TrackResult Tracker::accept(SegmentMemory& segment, TrackState state, const Burst& burst, const IcpResult& icp) {
  segment.motion.add(burst.t, icp.T_model_cam, burst.twist);
  segment.last_patch = {burst.patch, icp.T_model_cam};
  if (segment.keyframes.wants(icp.T_model_cam)) {
    segment.keyframes.add(*burst.patch, icp.T_model_cam, viewer_(*burst.patch, icp.T_model_cam));
  } else {
    segment.keyframes.describe_next_surface();
  }
  if (icp.weak_directions > 0 || state == TrackState::kStarted) remember_texture(segment, burst, icp);
  return {state,       icp.T_model_cam,  icp.rms_mm,
          icp.overlap, icp.iterations,   segment.id,
          {},          icp.undetermined, burst.texture.picture_if_made()};
}

}  // namespace enamel::pipeline
