// A recording through the scan pipeline. Lossless: every burst in log order, as fast as it goes, the same bits every
// time. Paced: at recorded speed through the live ingress gate.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "host/ingest/ingress_gate.hpp"
#include "host/record/burst_stream.hpp"
#include "host/report/accounting.hpp"
#include "host/session/burst_numbering.hpp"
#include "host/session/pipeline_config.hpp"
#include "host/session/scan_pipeline.hpp"

namespace enamel::host {

struct ReplayConfig {
  PipelineConfig pipeline;
  int workers = 2;
  bool paced = false;
  bool preview_model = false;     ///< mesh the growing model for a window
  std::uint32_t calib_crc32 = 0;  ///< bursts made with another calibration are rejected; 0: any
  std::size_t gate_bursts = 8;    ///< paced only, as live
};

struct ReplayView {
  std::uint64_t captured = 0, fused = 0, rejected = 0, shed = 0, damaged = 0;
};

class ReplaySession {
 public:
  [[nodiscard]] static Result<std::unique_ptr<ReplaySession>> create(std::unique_ptr<BurstStream> stream,
                                                                     const calib::Rig& rig, const ReplayConfig& config,
                                                                     Clock& clock);
  ~ReplaySession();

  void start();
  void stop();
  [[nodiscard]] bool ended() const { return ended_.load(std::memory_order_acquire); }
  [[nodiscard]] ReplayView view() const;
  [[nodiscard]] PreviewSlot& preview() { return pipeline_->preview(); }
  [[nodiscard]] bool simulated() const noexcept { return simulated_; }

  struct Outcome {
    ScanResult scan;
    BurstCounts counts;
    std::vector<Error> damages;  ///< records that could not be read, in order
  };
  [[nodiscard]] Result<Outcome> finish();

 private:
  ReplaySession(std::unique_ptr<BurstStream> stream, std::unique_ptr<ScanPipeline> pipeline, const ReplayConfig& config,
                Clock& clock);
  void run_reader(const std::stop_token& stop);
  void take(capture::Record record, const std::stop_token& stop);
  void take_burst(proto::Burst burst, const std::stop_token& stop);
  void run_forwarder();
  void pace(const proto::Burst& burst, const std::stop_token& stop);

  std::unique_ptr<BurstStream> stream_;
  std::unique_ptr<ScanPipeline> pipeline_;
  ReplayConfig config_;
  Clock& clock_;
  IngressGate<proto::Burst> gate_;
  std::optional<std::int64_t> clock_offset_ns_;  ///< host time of playing minus device time recorded
  bool simulated_ = false;

  mutable std::mutex mutex_;  // guards ledger_, recorded_sheds_
  LossLedger ledger_;
  std::optional<std::uint64_t> last_seq_;
  std::optional<std::uint32_t> session_id_;
  std::uint64_t read_ = 0, shed_ = 0, damaged_ = 0;
  std::vector<Error> damages_;  ///< reader thread, then the owner
  std::atomic<bool> ended_{false};
  std::jthread reader_thread_, forward_thread_;
};

}  // namespace enamel::host
