// The map while the scan goes on: a thread that works when no stage of the graph wants the processor. It bends what is
// shown to where the finished model will be, and what it has measured the map after the scan need not measure again.
// What comes out of a scan is the same bits whether it ran or how far it came.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "calib/model/rig.hpp"
#include "host/session/pipeline_config.hpp"
#include "host/session/segment_ledger.hpp"
#include "pipeline/model/segments/patch_store.hpp"
#include "pipeline/register/map/edge_memo.hpp"
#include "pipeline/register/map/map_bend.hpp"
#include "pipeline/types/patch.hpp"
#include "protocol/base/append_log.hpp"
#include "protocol/base/latest_slot.hpp"

namespace enamel::host {

/// A burst as it left fusion.
struct LiveBurst {
  BurstId id;
  DeviceTime t_mid;
  Pose T_segment_cam = Pose::Identity();
  SegmentId segment = kModelSegment;
  pipeline::StoredPatch patch;
  std::shared_ptr<const TexturePicture> texture;
};

/// note() from one thread, take_bend() from one thread, the rest from the owner.
class LiveMap {
 public:
  using Load = std::function<SurfacePatch(const pipeline::StoredPatch&)>;  ///< from a thread of its own
  LiveMap(const calib::Rig& rig, const PipelineConfig& config, Load load);
  LiveMap(const LiveMap&) = delete;
  LiveMap& operator=(const LiveMap&) = delete;
  ~LiveMap();

  /// A burst was placed; `segments` knows where its segment lies by now. Never waits.
  void note(LiveBurst burst, const SegmentLedger& segments, std::uint8_t soft_below);
  /// Once for every new one.
  [[nodiscard]] std::optional<std::shared_ptr<const pipeline::MapBend>> take_bend() { return bends_.take(); }
  /// Ends the thread. What it has measured.
  [[nodiscard]] pipeline::EdgeMemo& finish();

 private:
  struct Placed {
    AppendLog<LiveBurst>::View bursts;                 ///< in the order in which they were placed
    std::vector<std::optional<Pose>> T_model_segment;  ///< by segment; none: it stands apart
    std::uint8_t soft_below = kNothingSoft;
  };
  class Follower;
  void run(const std::stop_token& stop);

  calib::Rig rig_;
  PipelineConfig config_;
  Load load_;
  pipeline::EdgeMemo memo_;
  AppendLog<LiveBurst> placed_;
  LatestSlot<std::shared_ptr<const Placed>> newest_;
  std::atomic<std::uint32_t> news_{0};
  LatestSlot<std::shared_ptr<const pipeline::MapBend>> bends_;
  std::jthread thread_;  // last: ends before what it uses
};

}  // namespace enamel::host
