#include "host/session/live_session.hpp"

#include <algorithm>
#include <utility>

#include "calib/model/measuring_rig.hpp"
#include "host/ingest/probe_facts.hpp"
#include "host/record/calibration_attachment.hpp"
#include "host/record/session_stream.hpp"
#include "host/session/probe_counts.hpp"
#include "protocol/base/log.hpp"
#include "protocol/base/utc.hpp"

namespace enamel::host {

namespace {

ScanState scan_state(FeedState state) {
  switch (state) {
    case FeedState::kWaiting:
      return ScanState::kWaitingForProbe;
    case FeedState::kScanning:
      return ScanState::kScanning;
    case FeedState::kPaused:
      return ScanState::kPaused;
    case FeedState::kLost:
      return ScanState::kProbeLost;
    case FeedState::kEnded:
      break;
  }
  return ScanState::kFinished;
}

}  // namespace

Result<std::unique_ptr<LiveSession>> LiveSession::create(const dds::Participant& participant,
                                                         const LiveSessionConfig& config, Clock& clock) {
  ENAMEL_TRY_ASSIGN(auto link, ProbeLink::create(participant, config.link, clock));
  LiveSessionConfig its_own = config;
  // The model is there before anything is added to it.
  if (!config.resume.empty()) its_own.feed.start_at_once = false;
  auto session = std::unique_ptr<LiveSession>(new LiveSession(std::move(link), its_own, clock));
  session->open_checkpoint();
  if (config.resume.empty()) return session;
  session->wanted_after_rebuild_ = config.feed.start_at_once;
  ENAMEL_TRY_ASSIGN(session->past_, open_parts(config.resume));
  session->rebuilt_ = false;
  return session;
}

LiveSession::LiveSession(std::unique_ptr<ProbeLink> link, const LiveSessionConfig& config, Clock& clock)
    : config_(config),
      clock_(clock),
      link_(std::move(link)),
      feed_(*link_, *this, config.feed, clock),
      gate_(config.gate_bursts, GatePolicy::kShedOldest) {}

LiveSession::~LiveSession() {
  stop();
  gate_.close();
}

void LiveSession::start() {
  if (past_) {
    if (const auto begun = start_pipeline(past_->rig_text(), says_simulated(past_->info())); !begun) {
      feed_error_ = begun.error();
      on_state(FeedState::kEnded, begun.error().message());
      ended_.store(true, std::memory_order_release);
      return;
    }
  }
  ingest_thread_ = std::jthread([this](const std::stop_token& token) { run_ingest(token); });
}

void LiveSession::stop() {
  ingest_thread_.request_stop();
  link_->wake();
}

void LiveSession::run_ingest(const std::stop_token& stop) {
  if (const auto ran = feed_.run(stop); !ran) {
    feed_error_ = ran.error();
    on_state(FeedState::kEnded, ran.error().message());
  }
  gate_.close();
  if (!record_thread_.joinable()) ended_.store(true, std::memory_order_release);
}

// Everything that passes the gate is on disk before it enters the graph: the recording is what the pipeline saw.
void LiveSession::run_record() {
  BurstNumbering numbering;
  if (past_) rebuild(numbering);
  while (auto arrived = gate_.pop()) {
    if (recorder_) recorder_->write_burst(arrived->burst.cdr, arrived->arrival);
    {
      const std::lock_guard lock(mutex_);
      ledger_.accepted();
    }
    auto burst = std::make_shared<const proto::Burst>(std::move(arrived->burst.value));
    const BurstId id = numbering.number(*burst);
    pipeline_->push({id, std::move(burst), arrived->exposed, arrived->arrival});
  }
  pipeline_->finish();
  pipeline_->wait_drained();
  ended_.store(true, std::memory_order_release);
}

Result<void> LiveSession::start_pipeline(const std::string& text, bool simulated) {
  ENAMEL_TRY_ASSIGN(calib::Rig rig, calib::parse_rig(text));
  probe_rig_crc32_ = rig.crc32;
  if (config_.calibration) {
    ENAMEL_TRY_ASSIGN(rig, calib::measuring_rig(*config_.calibration, rig));
  }
  const ScanPipelineOptions options{.workers = config_.workers,
                                    .preview_model = config_.preview_model,
                                    .follow_map = true,
                                    .calib_crc32 = rig.crc32,
                                    .waiting_room = config_.gate_bursts,
                                    .on_preview = [this](const BurstPreview& shown) {
                                      if (checkpoint_ && rebuilt_.load(std::memory_order_acquire))
                                        checkpoint_->offer(shown);
                                    }};
  ENAMEL_TRY_ASSIGN(pipeline_, ScanPipeline::create(rig, config_.pipeline, options, clock_));
  {
    const std::lock_guard lock(mutex_);
    rig_ = rig;
    view_.simulated = simulated;
  }
  pipeline_ready_.store(pipeline_.get(), std::memory_order_release);
  record_thread_ = std::jthread([this] { run_record(); });
  return {};
}

Result<void> LiveSession::start_recorder(const proto::DeviceInfo& info, const std::string& text) {
  if (config_.recording_path.empty()) return {};
  ENAMEL_TRY_ASSIGN(recorder_, Recorder::create(config_.recording_path, header_of(info, text, config_.program)));
  disk_ = std::make_unique<DiskGuard>(config_.recording_path, config_.disk, [this] { stop(); });
  disk_ready_.store(disk_.get(), std::memory_order_release);
  recorder_->attach(capture::kConfigAttachment, "application/toml", config_.config_text);
  if (config_.calibration) {
    recorder_->attach(kCalibrationAttachment, "application/json", config_.calibration->text);
    recorder_->attach(kCalibrationReportAttachment, "application/json", config_.calibration_report);
  }
  recorder_->note(info, clock_.now());
  return {};
}

Result<void> LiveSession::on_probe(const proto::DeviceInfo& info, bool came_back) {
  const bool known = came_back || past_ != nullptr;
  if (known && info.calib_crc32 != probe_rig_crc32_) {
    return fail(ErrorCode::kRigForeign, "probe " + info.serial +
                                            (came_back ? " came back with another calibration"
                                                       : " is not calibrated as the one that began this session"));
  }
  if (came_back) return {};
  ENAMEL_TRY_ASSIGN(const std::string text, rig_text_of(info));
  ENAMEL_TRY(start_recorder(info, text));
  if (past_) return {};
  return start_pipeline(text, says_simulated(info));
}

void LiveSession::on_restart() {
  const std::lock_guard lock(mutex_);
  ledger_.probe_restarted();
}

void LiveSession::on_burst(dds::Received<proto::Burst> burst, HostTime arrival) {
  const bool whole = burst.valid && proto::is_consistent(burst.value);
  {
    const std::lock_guard lock(mutex_);
    if (burst.valid) enter_session(burst.value.session_id);
    burst.valid ? ledger_.received(burst.value.burst_seq) : ledger_.received_unreadable();
    if (!whole) ledger_.damaged();
  }
  if (!whole) return;
  // The waiting room lies behind the recorder: what is let in is on disk within a moment, whatever the graph is at.
  if (const ScanPipeline* pipeline = pipeline_ready_.load(std::memory_order_acquire);
      pipeline != nullptr && gate_.size() + pipeline->waiting() >= config_.gate_bursts) {
    note_shed(burst.value);
    return;
  }
  const auto exposed = link_->clock_map().to_host(end_of_exposure(burst.value));
  if (auto dropped = gate_.push({std::move(burst), arrival, exposed})) note_shed(dropped->burst.value);
}

void LiveSession::note_shed(const proto::Burst& burst) {
  const HostTime now = clock_.now();
  if (recorder_) {
    recorder_->note(proto::ShedNote{burst.burst_index, burst.burst_seq, to_ns(now), proto::ShedReason::kIngressFull},
                    now);
  }
  const std::lock_guard lock(mutex_);
  ledger_.shed();
}

void LiveSession::on_status(const proto::Status& status) {
  if (recorder_) recorder_->note(status, clock_.now());
  const std::lock_guard lock(mutex_);
  enter_session(status.session_id);
  // What a resumed session's probe began while nobody listened is told by its counters as they are now.
  const bool resumed = resumed_session_ && status.session_id == *resumed_session_;
  if (status.session_id != config_.feed.session_id && !resumed) {  // counters of a session before ours
    status_before_ = status;
    return;
  }
  ledger_.probe_status(counts_of(status));
}

void LiveSession::on_event(const proto::Event& event) {
  if (recorder_) recorder_->note(event, clock_.now());
}

void LiveSession::on_state(FeedState state, const std::string& message) {
  const std::lock_guard lock(mutex_);
  view_.state = scan_state(state);
  if (rebuilt_.load(std::memory_order_acquire)) view_.message = message;
}

PreviewFrame LiveSession::view() const {
  const ScanPipeline* pipeline = pipeline_ready_.load(std::memory_order_acquire);
  const std::lock_guard lock(mutex_);
  PreviewFrame view = view_;
  view.counters = counters_of(ledger_.counts());
  if (pipeline != nullptr) pipeline->count_into(view);
  if (const DiskGuard* disk = disk_ready_.load(std::memory_order_acquire); disk != nullptr && view.message.empty())
    view.message = disk->warning();
  return view;
}

PreviewSlot* LiveSession::preview() {
  if (knows_model_before_ && !rebuilt_.load(std::memory_order_acquire)) return &model_before_;
  ScanPipeline* pipeline = pipeline_ready_.load(std::memory_order_acquire);
  return pipeline != nullptr ? &pipeline->preview() : nullptr;
}

void LiveSession::shown(BurstId burst, HostTime at) {
  if (ScanPipeline* pipeline = pipeline_ready_.load(std::memory_order_acquire)) pipeline->shown(burst, at);
}

std::shared_ptr<const PipelineFigures> LiveSession::figures() const {
  const ScanPipeline* pipeline = pipeline_ready_.load(std::memory_order_acquire);
  return pipeline != nullptr ? pipeline->figures() : nullptr;
}

std::optional<calib::Rig> LiveSession::rig() const {
  const std::lock_guard lock(mutex_);
  return rig_;
}

Result<Outcome> LiveSession::finish() {
  if (ingest_thread_.joinable()) ingest_thread_.join();
  if (record_thread_.joinable()) record_thread_.join();
  if (!pipeline_)
    return tl::unexpected<Error>(feed_error_.value_or(Error{ErrorCode::kCancelled, "before a probe was found"}));
  ENAMEL_TRY(pipeline_->join());
  Outcome outcome;
  outcome.scan = pipeline_->take_result();
  if (recorder_) {
    recorder_->finish();
    outcome.recording_error = recorder_->error();
  }
  close_checkpoint();
  outcome.counts = ledger_.counts();
  outcome.counts.fused = outcome.scan.fused;
  outcome.counts.rejected = outcome.scan.rejected;
  outcome.simulated = view_.simulated;
  outcome.device_serial = rig_->serial;
  outcome.scanned_at = utc_text(wall_time());
  outcome.broken_off = feed_error_;
  if (disk_) {
    if (auto full = disk_->full(config_.recording_path)) outcome.broken_off = std::move(full);
    disk_->release_reserve();
  }
  outcome.damages = std::move(damages_);
  return outcome;
}

}  // namespace enamel::host
