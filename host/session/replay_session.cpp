#include "host/session/replay_session.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "protocol/base/log.hpp"

namespace enamel::host {

Result<std::unique_ptr<ReplaySession>> ReplaySession::create(std::unique_ptr<BurstStream> stream, const calib::Rig& rig,
                                                             const ReplayConfig& config, Clock& clock) {
  const ScanPipelineOptions options{.workers = config.workers,
                                    .preview_model = config.preview_model,
                                    .follow_map = config.preview_model,
                                    .calib_crc32 = config.calib_crc32};
  ENAMEL_TRY_ASSIGN(auto pipeline, ScanPipeline::create(rig, config.pipeline, options, clock));
  return std::unique_ptr<ReplaySession>(new ReplaySession(std::move(stream), std::move(pipeline), rig, config, clock));
}

ReplaySession::ReplaySession(std::unique_ptr<BurstStream> stream, std::unique_ptr<ScanPipeline> pipeline,
                             const calib::Rig& rig, const ReplayConfig& config, Clock& clock)
    : stream_(std::move(stream)),
      pipeline_(std::move(pipeline)),
      rig_(rig),
      config_(config),
      clock_(clock),
      gate_(config.paced ? config.gate_bursts : 2, config.paced ? GatePolicy::kShedOldest : GatePolicy::kLossless),
      simulated_(says_simulated(stream_->info())) {}

ReplaySession::~ReplaySession() {
  stop();
  gate_.close();
  pipeline_->finish();
}

void ReplaySession::start() {
  reader_thread_ = std::jthread([this](const std::stop_token& token) { run_reader(token); });
  forward_thread_ = std::jthread([this] { run_forwarder(); });
}

void ReplaySession::stop() {
  reader_thread_.request_stop();
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  set_scanning(true);  // wakes a paused reader, which then sees the request
}

void ReplaySession::set_scanning(bool wanted) {
  {
    const std::lock_guard lock(mutex_);
    wanted_.store(wanted || stopped_, std::memory_order_release);
  }
  wanted_.notify_all();
}

void ReplaySession::wait_while_paused() {
  if (scanning_wanted()) return;
  wanted_.wait(false, std::memory_order_acquire);
  clock_offset_ns_.reset();
}

void ReplaySession::run_reader(const std::stop_token& stop) {
  for (wait_while_paused(); !stop.stop_requested(); wait_while_paused()) {
    auto next = stream_->next();
    if (!next) {
      // The damaged record is passed over, counted, and told at the end; the stream goes on behind it.
      log::warn("replay", "{}", next.error().detail);
      damages_.push_back(next.error());
      const std::lock_guard lock(mutex_);
      counts_.lost_so_far(stream_->bursts_lost());
      continue;
    }
    if (!next->has_value()) break;
    take(std::move(**next), stop);
  }
  gate_.close();
}

void ReplaySession::take(capture::Record record, const std::stop_token& stop) {
  {
    const std::lock_guard lock(mutex_);
    const auto* burst = counts_.take(record);
    if (burst == nullptr) {
      if (const auto* damaged = std::get_if<proto::Burst>(&record.value)) {
        damages_.push_back(
            {ErrorCode::kCaptureCorrupt, "burst " + std::to_string(damaged->burst_index) + " is inconsistent"});
      }
      return;
    }
  }
  auto burst = std::get<proto::Burst>(std::move(record.value));
  if (config_.paced) pace(burst, stop);
  if (gate_.push(std::move(burst))) {
    const std::lock_guard lock(mutex_);
    ledger_.shed();
  }
}

void ReplaySession::pace(const proto::Burst& burst, const std::stop_token& stop) {
  const auto recorded = static_cast<std::int64_t>(burst.t_first_exposure_ns);
  if (!clock_offset_ns_) clock_offset_ns_ = to_ns(clock_.now()) - recorded;
  HostTime due = host_time(recorded + *clock_offset_ns_);
  constexpr std::chrono::seconds kLongest{2};  // a pause in the recording is not waited out
  if (due > clock_.now() + kLongest || due + kLongest < clock_.now()) {
    due = clock_.now();
    clock_offset_ns_ = to_ns(due) - recorded;
  }
  if (!stop.stop_requested()) clock_.sleep_until(due);
}

void ReplaySession::run_forwarder() {
  BurstNumbering numbering;
  while (auto burst = gate_.pop()) {
    {
      const std::lock_guard lock(mutex_);
      ledger_.accepted();
    }
    auto shared = std::make_shared<const proto::Burst>(std::move(*burst));
    const BurstId id = numbering.number(*shared);
    pipeline_->push({id, std::move(shared), std::nullopt});
  }
  pipeline_->finish();
  pipeline_->wait_drained();
  ended_.store(true, std::memory_order_release);
}

PreviewFrame ReplaySession::view() const {
  PreviewFrame view;
  view.state = scanning_wanted() ? ScanState::kScanning : ScanState::kPaused;
  view.simulated = simulated_;
  {
    const std::lock_guard lock(mutex_);
    view.counters = counters_of(ledger_.counts());
  }
  pipeline_->count_into(view);
  return view;
}

Result<Outcome> ReplaySession::finish() {
  if (reader_thread_.joinable()) reader_thread_.join();
  if (forward_thread_.joinable()) forward_thread_.join();
  ENAMEL_TRY(pipeline_->join());
  Outcome outcome;
  outcome.scan = pipeline_->take_result();
  outcome.counts = ledger_.counts();
  outcome.counts.fused = outcome.scan.fused;
  outcome.counts.rejected = outcome.scan.rejected;
  outcome.simulated = simulated_;
  if (const auto recorded_rig = calib::parse_rig(stream_->rig_text())) outcome.device_serial = recorded_rig->serial;
  outcome.scanned_at = recorded_at(stream_->info());
  outcome.damages = std::move(damages_);
  for (const std::string& problem : stream_->info().problems)
    outcome.damages.push_back({ErrorCode::kCaptureCorrupt, problem});
  return outcome;
}

}  // namespace enamel::host
