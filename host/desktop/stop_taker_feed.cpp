// What a probe sends while stops are taken. On the ingest thread.
#include <utility>

#include "host/desktop/stop_taker.hpp"
#include "host/ingest/probe_facts.hpp"
#include "host/session/probe_counts.hpp"
#include "protocol/base/log.hpp"

namespace enamel::host {
namespace {

std::optional<HostExposure> exposure_of(const proto::Burst& burst, const ClockMap& map) {
  const auto began = map.to_host(device_time(static_cast<std::int64_t>(burst.meta.front().t_strobe_ns)));
  const auto ended = map.to_host(end_of_exposure(burst));
  if (!began || !ended) return std::nullopt;
  return HostExposure{*began, *ended, *map.uncertainty()};
}

}  // namespace

// With the lock held.
void StopTaker::note_left_out(const proto::Burst& burst, BurstPlace place) {
  ++(place == BurstPlace::kMoving ? moving_ : spare_);
  ledger_.shed();
  if (!recorder_) return;
  const HostTime now = clock_.now();
  recorder_->note(proto::ShedNote{burst.burst_index, burst.burst_seq, to_ns(now), proto::ShedReason::kOther}, now);
}

Result<void> StopTaker::start_recorder(const proto::DeviceInfo& info, const std::string& rig_text) {
  if (config_.recording_path.empty()) return {};
  ENAMEL_TRY_ASSIGN(auto recorder,
                    Recorder::create(config_.recording_path, header_of(info, rig_text, config_.program)));
  if (!config_.config_text.empty())
    recorder->attach(capture::kConfigAttachment, "application/toml", config_.config_text);
  recorder->note(info, clock_.now());
  auto disk = std::make_unique<DiskGuard>(
      config_.recording_path, config_.disk, [] {}, config_.free_bytes);
  const std::lock_guard lock(mutex_);
  recorder_ = std::move(recorder);
  disk_ = std::move(disk);
  return {};
}

Result<void> StopTaker::on_probe(const proto::DeviceInfo& info, bool came_back) {
  if (came_back) {
    const std::lock_guard lock(mutex_);
    if (info.calib_crc32 == probe_->calib_crc32) return {};
    return fail(ErrorCode::kRigForeign, "probe " + info.serial + " came back with another calibration");
  }
  ENAMEL_TRY_ASSIGN(const std::string text, rig_text_of(info));
  ENAMEL_TRY(start_recorder(info, text));
  const std::lock_guard lock(mutex_);
  probe_ = info;
  return {};
}

void StopTaker::on_restart() {
  const std::lock_guard lock(mutex_);
  ledger_.probe_restarted();
  has_restarted_ = true;
  if (!ends_here()) return;
  feed_.set_scanning(false);
  log::warn("desktop", "the probe was started anew: its light stays off, and the scan ends with what was taken");
}

void StopTaker::on_burst(dds::Received<proto::Burst> burst, HostTime) {
  const bool whole = burst.valid && proto::is_consistent(burst.value);
  const std::lock_guard lock(mutex_);
  // Of a host before this one, that was killed.
  if (burst.valid && burst.value.session_id != config_.feed.session_id) return;
  burst.valid ? ledger_.received(burst.value.burst_seq) : ledger_.received_unreadable();
  if (!whole) return ledger_.damaged();
  const BurstPlace place = window_.place_of(exposure_of(burst.value, link_->clock_map()));
  const bool is_wanted = at_stop_.size() < wanted_ && (wanted_us_ == 0 || is_exposed(burst.value, wanted_us_));
  if (place == BurstPlace::kAtStop && is_wanted) {
    at_stop_.push_back(std::move(burst));
    return;
  }
  note_left_out(burst.value, place);
}

void StopTaker::on_status(const proto::Status& status) {
  const std::lock_guard lock(mutex_);
  knows_clock_ = link_->clock_map().uncertainty().has_value();
  if (recorder_) recorder_->note(status, clock_.now());
  if (status.session_id == config_.feed.session_id) ledger_.probe_status(counts_of(status));
}

void StopTaker::on_exposure(std::uint32_t exposure_us, const Result<void>& done) {
  if (done) return;
  const std::lock_guard lock(mutex_);
  if (!refused_us_.insert(exposure_us).second) return;
  log::warn("desktop", "stops go without an exposure of {} us: {}", exposure_us, done.error().detail);
}

void StopTaker::on_event(const proto::Event& event) {
  const std::lock_guard lock(mutex_);
  if (recorder_) recorder_->note(event, clock_.now());
}

void StopTaker::on_state(FeedState state, const std::string&) {
  const std::lock_guard lock(mutex_);
  feed_state_ = state;
}

}  // namespace enamel::host
