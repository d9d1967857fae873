#include "host/session/live_session.hpp"

#include <algorithm>
#include <utility>

#include "calib/model/measuring_rig.hpp"
#include "host/record/calibration_attachment.hpp"
#include "host/session/probe_counts.hpp"
#include "protocol/base/log.hpp"
#include "protocol/base/utc.hpp"

namespace enamel::host {

namespace {

DeviceTime end_of_burst(const proto::Burst& burst) {
  const proto::FrameMeta& last = burst.meta.back();
  return device_time(static_cast<std::int64_t>(last.t_strobe_ns) + std::int64_t{last.exposure_us} * 1000);
}

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
  return std::unique_ptr<LiveSession>(new LiveSession(std::move(link), config, clock));
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
  while (auto arrived = gate_.pop()) {
    if (recorder_) recorder_->write_burst(arrived->burst.cdr, arrived->arrival);
    {
      const std::lock_guard lock(mutex_);
      ledger_.accepted();
    }
    auto burst = std::make_shared<const proto::Burst>(std::move(arrived->burst.value));
    const BurstId id = numbering.number(*burst);
    pipeline_->push({id, std::move(burst), arrived->exposed});
  }
  pipeline_->finish();
  pipeline_->wait_drained();
  ended_.store(true, std::memory_order_release);
}

Result<void> LiveSession::start_pipeline(const proto::DeviceInfo& info) {
  std::string text(info.calibration_blob.begin(), info.calibration_blob.end());
  if (text.empty()) return fail(ErrorCode::kRigMissing, "probe " + info.serial + " carries none");
  ENAMEL_TRY_ASSIGN(calib::Rig rig, calib::parse_rig(text));
  if (rig.crc32 != info.calib_crc32) return fail(ErrorCode::kRigInvalid, "damaged on its way from the probe");
  if (config_.calibration) {
    ENAMEL_TRY_ASSIGN(rig, calib::measuring_rig(*config_.calibration, rig));
  }
  const ScanPipelineOptions options{
      .workers = config_.workers, .preview_model = config_.preview_model, .calib_crc32 = rig.crc32};
  ENAMEL_TRY_ASSIGN(pipeline_, ScanPipeline::create(rig, config_.pipeline, options, clock_));
  if (!config_.recording_path.empty()) {
    const capture::CaptureHeader header{
        text, config_.program, {{"serial", info.serial}, {"model", info.model}, {kRecordedAt, utc_text(wall_time())}}};
    ENAMEL_TRY_ASSIGN(recorder_, Recorder::create(config_.recording_path, header));
    recorder_->attach(capture::kConfigAttachment, "application/toml", config_.config_text);
    if (config_.calibration) {
      recorder_->attach(kCalibrationAttachment, "application/json", config_.calibration->text);
      recorder_->attach(kCalibrationReportAttachment, "application/json", config_.calibration_report);
    }
    recorder_->note(info, clock_.now());
  }
  {
    const std::lock_guard lock(mutex_);
    rig_ = rig;
    view_.simulated = info.model.find("SIMULATED") != std::string::npos;
  }
  pipeline_ready_.store(pipeline_.get(), std::memory_order_release);
  record_thread_ = std::jthread([this] { run_record(); });
  return {};
}

Result<void> LiveSession::on_probe(const proto::DeviceInfo& info, bool came_back) {
  if (!came_back) return start_pipeline(info);
  const std::lock_guard lock(mutex_);
  if (rig_ && info.calib_crc32 != rig_->crc32) {
    return fail(ErrorCode::kRigForeign, "probe " + info.serial + " came back with another calibration");
  }
  return {};
}

void LiveSession::on_restart() {
  const std::lock_guard lock(mutex_);
  ledger_.probe_restarted();
}

void LiveSession::on_burst(dds::Received<proto::Burst> burst, HostTime arrival) {
  const bool whole = burst.valid && proto::is_consistent(burst.value);
  {
    const std::lock_guard lock(mutex_);
    burst.valid ? ledger_.received(burst.value.burst_seq) : ledger_.received_unreadable();
    if (!whole) ledger_.damaged();
  }
  if (!whole) return;
  const auto exposed = link_->clock_map().to_host(end_of_burst(burst.value));
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
  if (status.session_id != config_.feed.session_id) return;  // counters of a session before ours
  const std::lock_guard lock(mutex_);
  ledger_.probe_status(counts_of(status));
}

void LiveSession::on_event(const proto::Event& event) {
  if (recorder_) recorder_->note(event, clock_.now());
}

void LiveSession::on_state(FeedState state, const std::string& message) {
  const std::lock_guard lock(mutex_);
  view_.state = scan_state(state);
  view_.message = message;
}

PreviewFrame LiveSession::view() const {
  const ScanPipeline* pipeline = pipeline_ready_.load(std::memory_order_acquire);
  const std::lock_guard lock(mutex_);
  PreviewFrame view = view_;
  view.counters = counters_of(ledger_.counts());
  if (pipeline != nullptr) pipeline->count_into(view);
  return view;
}

PreviewSlot* LiveSession::preview() {
  ScanPipeline* pipeline = pipeline_ready_.load(std::memory_order_acquire);
  return pipeline != nullptr ? &pipeline->preview() : nullptr;
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
  outcome.counts = ledger_.counts();
  outcome.counts.fused = outcome.scan.fused;
  outcome.counts.rejected = outcome.scan.rejected;
  outcome.simulated = view_.simulated;
  outcome.device_serial = rig_->serial;
  outcome.scanned_at = utc_text(wall_time());
  outcome.broken_off = feed_error_;
  return outcome;
}

}  // namespace enamel::host
