// The two ends of the scan graph: bursts come in from another thread, results are collected.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <iterator>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "host/ingest/ingress_gate.hpp"
#include "host/report/stage_trace.hpp"
#include "host/session/bent_model.hpp"
#include "host/session/live_map.hpp"
#include "host/session/scan_pipeline.hpp"
#include "host/session/segment_ledger.hpp"
#include "pipeline/decode/steps/decoded_burst.hpp"
#include "pipeline/decode/steps/frame_gates.hpp"
#include "pipeline/flow/stage.hpp"
#include "pipeline/register/track/mid_burst.hpp"
#include "pipeline/stages/burst_view.hpp"
#include "pipeline/stages/items.hpp"
#include "pipeline/types/preview.hpp"
#include "protocol/base/clock.hpp"
#include "protocol/base/metrics.hpp"

namespace enamel::host {

class SourceStage final : public flow::Source {
 public:
  explicit SourceStage(IngressGate<Accepted>& gate) : Source("source"), gate_(gate) {}
  flow::Out<proto::Burst> burst{*this, "burst"};

  Result<flow::Pull> pull() override {
    auto next = gate_.try_pop();
    if (!next) return gate_.drained() ? flow::Pull::kEnd : flow::Pull::kNotYet;
    flow::ItemHead head;
    head.id = next->id;
    head.captured = proto::mid_burst(*next->burst);
    if (any_before(*next->burst, pipeline::has_stale_frame)) {
      burst.emit_rejected(head, pipeline::name_of(pipeline::BurstVerdict::kPatternMismatch).data());
    } else {
      if (any_before(*next->burst, pipeline::is_repeated)) repeated.push_back(head.id);
      burst.emit(flow::make_item<proto::Burst>(head, next->burst));
    }
    before_[pulled_++ % before_.size()] = next->burst;
    return flow::Pull::kItem;
  }

  std::vector<BurstId> repeated;  ///< byte for byte a burst before; they are measured again. Read after the run

 private:
  using Beside = bool (*)(const pipeline::BurstView&, const pipeline::BurstView&) noexcept;
  /// Here, where bursts are in order: what decodes them may be replicated.
  [[nodiscard]] bool any_before(const proto::Burst& now, Beside is) const {
    return std::ranges::any_of(before_, [&](const std::shared_ptr<const proto::Burst>& was) {
      return was != nullptr && is(stage::view_of(now), stage::view_of(*was));
    });
  }

  IngressGate<Accepted>& gate_;
  std::array<std::shared_ptr<const proto::Burst>, pipeline::kBurstsRemembered> before_;
  std::size_t pulled_ = 0;
};

/// When bursts inside the graph were exposed, in order of burst: noted as they go in, asked for as they come out.
class ExposureTimes {
 public:
  void note(BurstId id, HostTime exposed) {
    const std::lock_guard lock(mutex_);
    exposed_[id.value] = exposed;
  }
  /// Forgets it, and the oldest that never came out.
  [[nodiscard]] std::optional<HostTime> take(BurstId id) {
    const std::lock_guard lock(mutex_);
    const auto found = exposed_.find(id.value);
    if (found == exposed_.end()) return std::nullopt;
    const HostTime exposed = found->second;
    exposed_.erase(exposed_.begin(), std::next(found));
    return exposed;
  }

 private:
  std::mutex mutex_;
  std::map<std::uint64_t, HostTime> exposed_;
};

/// Counts every burst that comes out, fused or rejected, and keeps poses and digests.
class SinkStage final : public flow::Stage {
 public:
  SinkStage(const Clock& clock, ExposureTimes& exposures) : Stage("sink"), clock_(clock), exposures_(exposures) {}
  flow::In<stage::Fused> fused{*this, "fused"};

  [[nodiscard]] bool handles_rejected() const noexcept override { return true; }
  Result<void> step() override {
    const auto item = fused.take();
    if (const auto exposed = exposures_.take(item.id)) latency_ns.record((clock_.now() - *exposed).count());
    if (last_captured_ && item.captured <= *last_captured_) clock_went_back.push_back(item.id);
    last_captured_ = item.captured;
    TraceRow row{item.id.value, {}, item.ok() ? "fused" : item.rejected};
    if (item.ok()) {
      const stage::Digests& d = item->digests;
      row.digest = {d.input, d.decode, d.track, d.fuse};
      segments.placed(item.id, item->track);
      if (item->track.undetermined > 0) undetermined.push_back(item.id);
      placed.push_back({item.id, item->track.segment, item->sight});
      poses.push_back({item.captured, item->track.T_model_cam, item->motion});
      if (live_map != nullptr) {
        live_map->note(
            {item.id, item.captured, item->track.T_model_cam, item->track.segment, item->kept, item->track.texture},
            segments, item->soft_below);
      }
      add(item->orders);
      add(item->sight);
      fused_count.add();
    } else {
      ++rejected[item.rejected];
      rejected_count.add();
    }
    trace.add(std::move(row));
    return {};
  }

  StageTrace trace;
  struct Placed {
    BurstId id;
    SegmentId segment;
    Sight sight;
  };
  std::vector<Placed> placed;                 ///< the fused bursts, in order …
  std::vector<pipeline::MeasuredPose> poses;  ///< … and where they were in the frames of their segments
  std::vector<BurstId> undetermined;          ///< of these, those whose motion neither shape nor texture told
  std::vector<BurstId> clock_went_back;       ///< bursts that are no younger than the one before them
  SegmentLedger segments;
  OrderTotals orders;
  SightTotals sight;
  std::map<std::string, std::uint64_t> rejected;
  Counter fused_count, rejected_count;  ///< readable from any thread
  LogHistogram latency_ns;              ///< last exposure to fused; live only
  LiveMap* live_map = nullptr;          ///< follows the scan, or null

 private:
  void add(const OrderCheck& check) {
    orders.checked_px += check.checked;
    orders.contradicting_px += check.contradicting;
    orders.suspect_bursts += check.suspect ? 1U : 0U;
    orders.guided_px += check.guided_px;
    orders.withdrawn_px += check.withdrawn_px;
  }
  void add(const Sight& seen) {
    const auto trouble = static_cast<std::size_t>(seen.trouble);
    if (trouble > 0) ++sight.bursts[std::string(kSightTroubleNames[trouble])];
    if (!(seen.apparent_depth_mm > 0)) return;
    ++sight.translucent_bursts;
    sight.translucent_share += static_cast<double>(seen.translucent_share);
    sight.lifted_mm += static_cast<double>(seen.translucent_share * seen.apparent_depth_mm);
    sight.unsure_share = kApparentDepthUnsure;
  }

  const Clock& clock_;
  ExposureTimes& exposures_;
  std::optional<DeviceTime> last_captured_;
};

/// End of the keep-latest edge: hands the newest item to whoever draws, where the map has it by now.
class PreviewStage final : public flow::Stage {
 public:
  /// `map` may be null.
  PreviewStage(PreviewSlot& slot, LiveMap* map, std::function<void(const BurstPreview&)> also)
      : Stage("preview"), slot_(slot), map_(map), also_(std::move(also)) {}
  flow::In<BurstPreview> item{*this, "item"};

  Result<void> step() override {
    if (auto bend = map_ != nullptr ? map_->take_bend() : std::nullopt) bent_.bend_by(std::move(*bend));
    auto shown = bent_(item.take().value);
    if (also_) also_(*shown);
    slot_.put(std::move(shown));
    return {};
  }

 private:
  PreviewSlot& slot_;
  LiveMap* map_;
  std::function<void(const BurstPreview&)> also_;
  BentModel bent_;
};

}  // namespace enamel::host
