#include "host/session/final_map.hpp"

#include <chrono>
#include <future>
#include <utility>

#include "protocol/base/log.hpp"

namespace enamel::host {
namespace {

/// Unpacks the next patch on another thread while this one is fused.
class ReadAhead {
 public:
  ReadAhead(const std::vector<pipeline::KeptBurst>& bursts, const pipeline::Unpacker& unpack)
      : bursts_(bursts), unpack_(unpack) {
    ask(0);
  }
  SurfacePatch operator()(std::size_t n) {
    SurfacePatch patch = next_.get();
    ask(n + 1);
    return patch;
  }

 private:
  void ask(std::size_t n) {
    if (n >= bursts_.size()) return;
    next_ = std::async(std::launch::async, [this, n] { return unpack_(bursts_[n].patch); });
  }
  const std::vector<pipeline::KeptBurst>& bursts_;
  const pipeline::Unpacker& unpack_;
  std::future<SurfacePatch> next_;
};

double seconds_since(HostTime start, const Clock& clock) {
  return std::chrono::duration<double>(clock.now() - start).count();
}

}  // namespace

MapFacts refine_model(const FinalMapInput& input, std::vector<MeasuredBurst>& placed, stage::FuseStage& fuse,
                      const Clock& clock) {
  const HostTime start = clock.now();
  std::vector<pipeline::KeptBurst> history = fuse.segments().take_history();
  MapFacts facts;
  if (history.size() != placed.size() || history.empty()) return facts;
  const pipeline::Unpacker& unpack = fuse.segments().unpack();
  pipeline::MapInput map;
  for (const MeasuredBurst& burst : placed) map.bursts.push_back({burst.pose.t_mid, burst.pose.T_model_cam});
  map.load = [&](std::size_t n) { return unpack(history[n].patch); };
  map.threads = input.threads;
  map.progress = [](double share) { log::info("map", "refining the poses: {:.0f} %", 100 * share); };
  const auto refined = pipeline::refine_map(map, input.rig, input.config.track.icp, input.config.map);
  facts.refine_s = seconds_since(start, clock);
  facts.map = refined;
  facts.map.poses = {};
  for (std::size_t n = 0; n < placed.size(); ++n) {
    placed[n].pose.T_model_cam = refined.poses[n];
    history[n].T_segment_cam = refined.poses[n];
  }
  log::info("map", "fusing {} bursts anew", history.size());
  ReadAhead ahead(history, unpack);
  fuse.rebuild(history, [&](std::size_t n) { return ahead(n); });
  facts.seconds = seconds_since(start, clock);
  return facts;
}

}  // namespace enamel::host
