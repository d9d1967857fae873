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
#include "host/session/burst_numbering.hpp"
#include "host/session/pipeline_config.hpp"
#include "host/session/recorded_counts.hpp"
#include "host/session/session.hpp"

namespace enamel::host {

struct ReplayConfig {
  PipelineConfig pipeline;
  int workers = 2;
  bool paced = false;
  bool preview_model = false;     ///< mesh the growing model for a window
  std::uint32_t calib_crc32 = 0;  ///< bursts made with another calibration are rejected; 0: any
  std::size_t gate_bursts = 8;    ///< paced only, as live
};

class ReplaySession final : public Session {
 public:
  [[nodiscard]] static Result<std::unique_ptr<ReplaySession>> create(std::unique_ptr<BurstStream> stream,
                                                                     const calib::Rig& rig, const ReplayConfig& config,
                                                                     Clock& clock);
  ~ReplaySession() override;

  void start() override;
  void stop() override;
  /// Reading rests and goes on; in a paced replay recorded time rests as well.
  void set_scanning(bool wanted) override;
  [[nodiscard]] bool scanning_wanted() const override { return wanted_.load(std::memory_order_acquire); }
  [[nodiscard]] bool ended() const override { return ended_.load(std::memory_order_acquire); }

  [[nodiscard]] PreviewFrame view() const override;
  [[nodiscard]] PreviewSlot* preview() override { return &pipeline_->preview(); }
  void shown(BurstId burst, HostTime at) override { pipeline_->shown(burst, at); }
  [[nodiscard]] std::shared_ptr<const PipelineFigures> figures() const override { return pipeline_->figures(); }
  [[nodiscard]] std::optional<calib::Rig> rig() const override { return rig_; }
  [[nodiscard]] Result<Outcome> finish() override;

 private:
  ReplaySession(std::unique_ptr<BurstStream> stream, std::unique_ptr<ScanPipeline> pipeline, const calib::Rig& rig,
                const ReplayConfig& config, Clock& clock);
  void wait_while_paused();
  void run_reader(const std::stop_token& stop);
  void take(capture::Record record, const std::stop_token& stop);
  void run_forwarder();
  void pace(const proto::Burst& burst, const std::stop_token& stop);

  std::unique_ptr<BurstStream> stream_;
  std::unique_ptr<ScanPipeline> pipeline_;
  calib::Rig rig_;
  ReplayConfig config_;
  Clock& clock_;
  IngressGate<proto::Burst> gate_;
  std::optional<std::int64_t> clock_offset_ns_;  ///< host time of playing minus device time recorded
  bool simulated_ = false;

  mutable std::mutex mutex_;  // guards ledger_, stopped_
  LossLedger ledger_;
  RecordedCounts counts_{ledger_};
  std::vector<Error> damages_;  ///< reader thread, then the owner
  std::atomic<bool> wanted_{true};
  bool stopped_ = false;  ///< for good: no pause any more
  std::atomic<bool> ended_{false};
  std::jthread reader_thread_, forward_thread_;
};

}  // namespace enamel::host
