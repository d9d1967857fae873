// One live scan: what the link hears goes through the ingress gate and the recorder into the scan pipeline, and every
// burst is accounted for. Threads: "ingest" (link), "record" (recorder and hand-over to the graph), the graph's
// workers.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "host/ingest/ingress_gate.hpp"
#include "host/ingest/live_feed.hpp"
#include "host/record/burst_stream.hpp"
#include "host/report/accounting.hpp"
#include "host/session/burst_numbering.hpp"
#include "host/session/disk_guard.hpp"
#include "host/session/model_checkpoint.hpp"
#include "host/session/pipeline_config.hpp"
#include "host/session/recorder.hpp"
#include "host/session/session.hpp"

namespace enamel::host {

struct LiveSessionConfig {
  ProbeLinkConfig link;
  FeedConfig feed;
  PipelineConfig pipeline;
  std::optional<calib::Rig> calibration;  ///< measures instead of the probe's own; one of another serial is refused
  std::string calibration_report;         ///< JSON of the solver, attached to the recording; may be empty
  std::string config_text;                ///< resolved configuration, attached to the recording
  std::string recording_path;             ///< empty: none
  /// Recordings of the session so far, in order: the model is rebuilt from them, then the scan goes on.
  std::vector<std::string> resume;
  DiskLimits disk;                               ///< of where the recording lies
  Nanoseconds checkpoint_period{2'000'000'000};  ///< how old the model may be that is shown at once after a crash
  std::string program;                           ///< "enamel 0.1.0"
  std::size_t gate_bursts = 8;                   ///< waiting room in front of the graph; a burst is 1.2 MB
  int workers = 2;
  bool preview_model = true;  ///< mesh the growing model for a window
};

class LiveSession final : public Session, private FeedSink {
 public:
  /// Errors: kDds, kFileWrite; with `resume` those of open_parts.
  [[nodiscard]] static Result<std::unique_ptr<LiveSession>> create(const dds::Participant& participant,
                                                                   const LiveSessionConfig& config, Clock& clock);
  ~LiveSession() override;

  void start() override;
  void stop() override;
  void set_scanning(bool wanted) override { feed_.set_scanning(wanted); }
  [[nodiscard]] bool scanning_wanted() const override { return feed_.scanning_wanted(); }
  [[nodiscard]] bool ended() const override { return ended_.load(std::memory_order_acquire); }

  [[nodiscard]] PreviewFrame view() const override;
  [[nodiscard]] PreviewSlot* preview() override;
  void shown(BurstId burst, HostTime at) override;
  [[nodiscard]] std::shared_ptr<const PipelineFigures> figures() const override;
  [[nodiscard]] std::optional<calib::Rig> rig() const override;
  [[nodiscard]] Result<Outcome> finish() override;

 private:
  struct Arrived {
    dds::Received<proto::Burst> burst;
    HostTime arrival;
    std::optional<HostTime> exposed;
  };

  LiveSession(std::unique_ptr<ProbeLink> link, const LiveSessionConfig& config, Clock& clock);
  void run_ingest(const std::stop_token& stop);
  void run_record();
  void note_shed(const proto::Burst& burst);
  /// Pipeline and thread, for the rig in `text` of a probe that may be simulated.
  [[nodiscard]] Result<void> start_pipeline(const std::string& text, bool simulated);
  [[nodiscard]] Result<void> start_recorder(const proto::DeviceInfo& info, const std::string& text);
  /// The model as it was last seen, to be shown until it is rebuilt; then its file is this session's.
  void open_checkpoint();
  [[nodiscard]] std::string checkpoint_file() const;
  void close_checkpoint();
  /// Pushes the recorded bursts of the session so far.
  void rebuild(BurstNumbering& numbering);
  /// Counters of `session_id` follow: those of the session that is resumed are over once ours have begun.
  void enter_session(std::uint32_t session_id);

  Result<void> on_probe(const proto::DeviceInfo& info, bool came_back) override;
  void on_restart() override;
  void on_burst(dds::Received<proto::Burst> burst, HostTime arrival) override;
  void on_status(const proto::Status& status) override;
  void on_event(const proto::Event& event) override;
  void on_state(FeedState state, const std::string& message) override;

  LiveSessionConfig config_;
  Clock& clock_;
  std::unique_ptr<ProbeLink> link_;
  LiveFeed feed_;
  IngressGate<Arrived> gate_;  ///< on the way to the recorder; full only where the disk does not keep up
  std::unique_ptr<Recorder> recorder_;
  std::unique_ptr<DiskGuard> disk_;  ///< with the recorder
  std::atomic<DiskGuard*> disk_ready_{nullptr};
  std::unique_ptr<BurstStream> past_;  ///< record thread, once it runs
  std::atomic<bool> rebuilt_{true};
  std::unique_ptr<CheckpointWriter> checkpoint_;  ///< with a recording and somebody who watches
  PreviewSlot model_before_;                      ///< as it was on the screen when the session was broken off …
  bool knows_model_before_ = false;               ///< … where that is known
  bool wanted_after_rebuild_ = false;
  std::uint32_t probe_rig_crc32_ = 0;
  std::atomic<ScanPipeline*> pipeline_ready_{nullptr};
  std::unique_ptr<ScanPipeline> pipeline_;

  mutable std::mutex mutex_;  // guards ledger_, view_, rig_
  LossLedger ledger_;
  PreviewFrame view_;                             ///< state, message and badge
  std::optional<proto::Status> status_before_;    ///< newest of another session than ours
  std::optional<std::uint32_t> resumed_session_;  ///< until the probe has begun ours
  std::optional<calib::Rig> rig_;

  std::optional<Error> feed_error_;
  std::vector<Error> damages_;  ///< of the recordings so far; record thread, then the owner
  std::atomic<bool> ended_{false};
  std::jthread ingest_thread_, record_thread_;
};

}  // namespace enamel::host
