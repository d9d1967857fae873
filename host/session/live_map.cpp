#include "host/session/live_map.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "pipeline/register/map/follow_map.hpp"
#include "pipeline/register/map/map_measure.hpp"
#include "protocol/base/recent.hpp"

namespace enamel::host {
namespace {

constexpr std::size_t kPeriod = 8;      // bursts from one map to the next: a quarter of a second
constexpr std::size_t kNodesKept = 48;  // 2.5 MB each. A keyframe's neighbours of other passes move on with it
constexpr int kLastOfAll = 19;          // nice: whatever streams comes first

}  // namespace

/// What the thread remembers from one map to the next.
class LiveMap::Follower {
 public:
  explicit Follower(LiveMap& map)
      : map_(map), work_distance_mm_(calib::middle_depth_mm(map.rig_)), icp_(map.config_.track.icp) {}

  /// Null: stopped, or too little to go by.
  [[nodiscard]] std::shared_ptr<const pipeline::MapBend> follow(const Placed& placed, const std::stop_token& stop) {
    look_at(placed);
    pipeline::MapInput input;
    input.memo = &map_.memo_;
    for (const std::size_t n : in_model_) {
      const LiveBurst& burst = bursts_[n];
      input.bursts.push_back({burst.t_mid, *placed.T_model_segment[burst.segment] * burst.T_segment_cam, burst.id});
    }
    const auto moves = pipeline::follow_map(
        input, [&](std::size_t n) { return nodes_->get(in_model_[n]); }, map_.rig_, icp_, map_.config_.map, stop);
    return moves ? std::make_shared<const pipeline::MapBend>(*moves, work_distance_mm_) : nullptr;
  }

 private:
  /// Segments join and bursts of theirs come between those of the model: by number, as the map after the scan has them.
  void look_at(const Placed& placed) {
    bursts_ = placed.bursts.in_order();
    in_model_.clear();
    for (std::size_t n = 0; n < bursts_.size(); ++n)
      if (placed.T_model_segment[bursts_[n].segment]) in_model_.push_back(n);
    std::ranges::sort(in_model_, {}, [&](std::size_t n) { return bursts_[n].id.value; });
    map_.memo_.measured_with(placed.soft_below);
    if (nodes_ && nodes_->size() >= bursts_.size() && icp_.samples.soft_below == placed.soft_below) return;
    icp_.samples.soft_below = placed.soft_below;
    const auto make = [this, maker = pipeline::MapNodeMaker(map_.rig_, icp_, map_.config_.map)](std::size_t n) {
      return maker(map_.load_(bursts_[n].patch), bursts_[n].texture.get());
    };
    nodes_.emplace(2 * bursts_.size(), kNodesKept, make);
  }

  LiveMap& map_;
  double work_distance_mm_;
  pipeline::IcpConfig icp_;
  std::vector<LiveBurst> bursts_;
  std::vector<std::size_t> in_model_;               ///< of bursts_, in order of burst
  std::optional<Recent<pipeline::MapNode>> nodes_;  ///< by place in bursts_, which never changes
};

LiveMap::LiveMap(const calib::Rig& rig, const PipelineConfig& config, Load load)
    : rig_(rig), config_(config), load_(std::move(load)), thread_([this](const std::stop_token& stop) { run(stop); }) {}

LiveMap::~LiveMap() { static_cast<void>(finish()); }

void LiveMap::note(LiveBurst burst, const SegmentLedger& segments, std::uint8_t soft_below) {
  placed_.append(std::move(burst));
  if (placed_.size() % kPeriod != 0) return;
  auto placed = std::make_shared<Placed>();
  placed->bursts = placed_.view();
  placed->soft_below = soft_below;
  for (const SegmentRow& row : segments.rows()) {
    placed->T_model_segment.resize(row.id + 1);
    const SegmentLedger::Root root = segments.root_of(row.id);
    if (root.id == kModelSegment) placed->T_model_segment[row.id] = root.T_root_segment;
  }
  newest_.put(std::move(placed));
  news_.fetch_add(1, std::memory_order_release);
  news_.notify_one();
}

pipeline::EdgeMemo& LiveMap::finish() {
  if (thread_.joinable()) {
    thread_.request_stop();
    news_.fetch_add(1, std::memory_order_release);
    news_.notify_one();
    thread_.join();
  }
  return memo_;
}

void LiveMap::run(const std::stop_token& stop) {
  // Refused: it is a thread like others then.
  static_cast<void>(::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), kLastOfAll));
  Follower follower(*this);
  for (;;) {
    const std::uint32_t seen = news_.load(std::memory_order_acquire);
    if (stop.stop_requested()) return;
    if (const auto placed = newest_.take()) {
      if (auto bend = follower.follow(**placed, stop)) bends_.put(std::move(bend));
    } else {
      news_.wait(seen, std::memory_order_acquire);
    }
  }
}

}  // namespace enamel::host
