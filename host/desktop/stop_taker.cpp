#include "host/desktop/stop_taker.hpp"

#include <fmt/format.h>
#include <pthread.h>

#include <algorithm>
#include <utility>

#include "host/ingest/probe_facts.hpp"
#include "host/session/probe_counts.hpp"
#include "protocol/base/log.hpp"

namespace enamel::host {
namespace {

constexpr Nanoseconds kLook{5'000'000};  ///< how soon a wait notices what it waits for

double seconds_of(Nanoseconds t) { return std::chrono::duration<double>(t).count(); }

}  // namespace

Result<std::unique_ptr<StopTaker>> StopTaker::create(const dds::Participant& participant, const StopTakerConfig& config,
                                                     motion::Axes& axes, Clock& clock) {
  if (config.bursts < 1) return fail(ErrorCode::kUsage, "a stop needs one burst at least");
  ENAMEL_TRY_ASSIGN(auto link, ProbeLink::create(participant, config.link, clock));
  ENAMEL_TRY_ASSIGN(auto readings, dds::Writer<proto::AxesReading>::create(participant));
  return std::unique_ptr<StopTaker>(new StopTaker(std::move(link), std::move(readings), config, axes, clock));
}

StopTaker::StopTaker(std::unique_ptr<ProbeLink> link, dds::Writer<proto::AxesReading> readings,
                     const StopTakerConfig& config, motion::Axes& axes, Clock& clock)
    : config_(config),
      axes_(axes),
      clock_(clock),
      link_(std::move(link)),
      readings_(std::move(readings)),
      feed_(*link_, *this, config.feed, clock) {}

StopTaker::~StopTaker() { end_feed(); }

void StopTaker::end_feed() {
  if (!ingest_thread_.joinable()) return;
  ingest_thread_.request_stop();
  link_->wake();
  ingest_thread_.join();
}

Result<proto::DeviceInfo> StopTaker::start() {
  feed_.set_scanning(!is_paused());
  ingest_thread_ = std::jthread([this](const std::stop_token& stop) {
    const auto ran = feed_.run(stop);
    const std::lock_guard lock(mutex_);
    if (!ran) feed_error_ = ran.error();
    has_ended_ = true;
  });
  static_cast<void>(pthread_setname_np(ingest_thread_.native_handle(), "ingest"));
  HostTime deadline = clock_.now() + config_.start_within;
  for (;;) {
    ENAMEL_TRY(check_going());
    const HostTime paused_at = clock_.now();
    ENAMEL_TRY(wait_while_paused());
    deadline += clock_.now() - paused_at;
    {
      const std::lock_guard lock(mutex_);
      if (feed_state_ == FeedState::kScanning && knows_clock_) return *probe_;
    }
    if (clock_.now() > deadline) return tl::unexpected(silent());
    clock_.sleep_for(kLook);
  }
}

void StopTaker::set_paused(bool paused) noexcept {
  paused_.store(paused);
  const std::lock_guard lock(mutex_);
  feed_.set_scanning(!paused && !ends_here());
}

void StopTaker::request_stop() noexcept {
  stop_requested_.store(true);
  axes_.request_stop();
}

Result<void> StopTaker::check_going() const {
  if (stop_requested_) return fail(ErrorCode::kCancelled, "taking stops");
  const std::lock_guard lock(mutex_);
  if (feed_error_) return tl::unexpected<Error>(*feed_error_);
  if (disk_) {
    if (auto full = disk_->full(config_.recording_path)) return tl::unexpected<Error>(std::move(*full));
  }
  if (has_ended_) return fail(ErrorCode::kProbeLost, "the probe ended its session");
  if (ends_here()) {
    return fail(ErrorCode::kProbeLost,
                "it was started anew and numbers its bursts from the beginning: end this recording and begin another");
  }
  return {};
}

Result<void> StopTaker::wait_while_paused() {
  while (is_paused()) {
    ENAMEL_TRY(check_going());
    clock_.sleep_for(kLook);
  }
  return check_going();
}

Error StopTaker::silent() const {
  const std::lock_guard lock(mutex_);
  const std::string who = probe_ ? probe_->serial : "none yet";
  if (feed_state_ == FeedState::kLost) return {ErrorCode::kProbeLost, who + " did not come back in time"};
  return {ErrorCode::kProbeLost, fmt::format("{}: no burst came within {:.0f} s while the table stood", who,
                                             seconds_of(config_.burst_within))};
}

Result<void> StopTaker::wait_for_bursts() {
  int had = 0;
  HostTime deadline = clock_.now() + config_.burst_within;
  for (;;) {
    ENAMEL_TRY(check_going());
    const int has = bursts_at_stop();
    {
      const std::lock_guard lock(mutex_);
      if (at_stop_.size() >= wanted_ || refused_us_.contains(wanted_us_)) return {};
    }
    if (std::exchange(had, has) != has || is_paused()) deadline = clock_.now() + config_.burst_within;
    if (clock_.now() > deadline) return tl::unexpected(silent());
    clock_.sleep_for(kLook);
  }
}

Result<TakenStop> StopTaker::take(const motion::AxesAngles& target) {
  ENAMEL_TRY(wait_while_paused());
  ENAMEL_TRY_ASSIGN(const motion::AxesPosition position, axes_.move_to(target, config_.move_within));
  {
    const std::lock_guard lock(mutex_);
    window_.open(clock_.now());
    wanted_ = static_cast<std::size_t>(config_.bursts);
  }
  auto waited = wait_for_bursts();
  if (waited) waited = take_further_exposures();
  // Whoever pushed the table meanwhile shows now, not at the next stop.
  if (waited) waited = axes_.position().map([](const motion::AxesPosition&) {});
  auto bursts = close_window(waited.has_value());
  if (!waited) return tl::unexpected<Error>(waited.error());
  return keep(std::move(bursts), position);
}

Result<void> StopTaker::take_further_exposures() {
  if (config_.exposures.exposures == 1) return {};
  proto::Burst first;
  {
    const std::lock_guard lock(mutex_);
    first = at_stop_.front().value;
  }
  Result<void> waited;
  bool has_changed = false;
  for (const std::uint32_t us : further_exposures(first, config_.exposures)) {
    if (!waited || is_refused(us)) continue;
    has_changed = true;
    want(us);
    waited = wait_for_bursts();
  }
  if (!has_changed) return waited;
  feed_.set_exposure(0);
  const std::lock_guard lock(mutex_);
  wanted_ = at_stop_.size();
  wanted_us_ = first.meta.front().exposure_us;  // of the next stop; others are still under way
  return waited;
}

void StopTaker::want(std::uint32_t exposure_us) {
  {
    const std::lock_guard lock(mutex_);
    wanted_us_ = exposure_us;
    wanted_ = at_stop_.size() + static_cast<std::size_t>(config_.bursts);
  }
  feed_.set_exposure(exposure_us);
}

bool StopTaker::is_refused(std::uint32_t exposure_us) const {
  const std::lock_guard lock(mutex_);
  return refused_us_.contains(exposure_us);
}

std::vector<dds::Received<proto::Burst>> StopTaker::close_window(bool is_taken) {
  std::vector<dds::Received<proto::Burst>> bursts;
  const std::lock_guard lock(mutex_);
  window_.close(clock_.now());
  bursts.swap(at_stop_);
  if (is_taken) {
    for (std::size_t i = 0; i < bursts.size(); ++i) ledger_.accepted();
  } else {
    for (const auto& burst : bursts) note_left_out(burst.value, BurstPlace::kSpare);
    bursts.clear();
  }
  return bursts;
}

TakenStop StopTaker::keep(std::vector<dds::Received<proto::Burst>> bursts, const motion::AxesPosition& position) {
  std::ranges::sort(bursts, {}, [](const auto& b) { return b.value.meta.front().t_strobe_ns; });
  TakenStop taken{stops_++, position, {}};
  for (auto& burst : bursts) {
    angles_.push_back({burst.value.burst_index, position.commanded.rot_deg, position.commanded.swing_deg,
                       position.read.rot_deg, position.read.swing_deg, burst.value.probe_id, burst.value.session_id,
                       taken.stop});
    // Who follows the scan misses an angle where this fails; the recording and the scan itself do not.
    if (const auto told = readings_.write(angles_.back()); !told) log::warn("desktop", "{}", told.error().message());
    if (recorder_) {
      const HostTime now = clock_.now();
      recorder_->write_axes(angles_.back(), now);
      recorder_->write_burst(burst.cdr, now);
    }
    taken.bursts.push_back(std::make_shared<const proto::Burst>(std::move(burst.value)));
  }
  return taken;
}

void StopTaker::attach(const std::string& name, const std::string& media_type, const std::string& bytes) {
  if (recorder_) recorder_->attach(name, media_type, bytes);
}

TakeSummary StopTaker::finish() {
  end_feed();
  TakeSummary summary{.counts = counts(), .angles = angles_};
  summary.broken_off = feed_error_;
  if (recorder_) {
    recorder_->finish();
    summary.recording_error = recorder_->error();
    disk_->release_reserve();
  }
  return summary;
}

TakeCounts StopTaker::counts() const {
  const std::lock_guard lock(mutex_);
  return take_counts(ledger_.counts(), moving_, spare_);
}

FeedState StopTaker::feed_state() const {
  const std::lock_guard lock(mutex_);
  return feed_state_;
}

std::string StopTaker::disk_warning() const {
  const std::lock_guard lock(mutex_);
  return disk_ ? disk_->warning() : std::string();
}

int StopTaker::bursts_at_stop() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(at_stop_.size());
}

}  // namespace enamel::host
