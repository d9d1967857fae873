#include "host/ingest/live_feed.hpp"

#include <cstdint>
#include <numeric>
#include <utility>

#include "protocol/base/log.hpp"

namespace enamel::host {

namespace {

constexpr const char* kModule = "ingest";
constexpr Nanoseconds kStatusTimeout{2'000'000'000};   ///< ten times as long as a probe is silent
constexpr Nanoseconds kLeaseOfAnother{4'000'000'000};  ///< a probe's lease is 2.5 s
constexpr Nanoseconds kAskForLease{250'000'000};
constexpr Nanoseconds kAskAgain{1'000'000'000};

std::string words(const Error& error) { return error.message(); }

/// Scanning can be asked for; a probe that scans already says yes.
bool ready(proto::ProbeState state) {
  return state == proto::ProbeState::kReady || state == proto::ProbeState::kPaused ||
         state == proto::ProbeState::kScanning;
}

/// The probe has stopped, and every burst that it began was sent or dropped.
bool at_rest(const proto::Status& status) {
  const auto dropped = std::accumulate(status.dropped.begin(), status.dropped.end(), std::uint64_t{0});
  return status.state != proto::ProbeState::kScanning && status.bursts_begun == status.bursts_emitted + dropped;
}

}  // namespace

void LiveFeed::enter(FeedState state, const std::string& message) {
  if (state == state_ && message.empty()) return;
  state_ = state;
  sink_.on_state(state, message);
}

Result<void> LiveFeed::wait_for_probe(const std::stop_token& stop, bool came_back) {
  const HostTime deadline = clock_.now() + (came_back ? config_.lost_timeout : config_.find_timeout);
  std::optional<HostTime> first_seen;
  while (!stop.stop_requested()) {
    ENAMEL_TRY_ASSIGN(const auto found, link_.find());
    if (came_back) ENAMEL_TRY(take_input());
    const bool present = found && (!came_back || link_.alive());
    if (present && !first_seen) first_seen = clock_.now();
    // The one that was lost is known; at the begin a second one may take a moment longer to show itself.
    const Nanoseconds settle = came_back ? Nanoseconds{0} : config_.settle;
    if (present && clock_.now() - *first_seen >= settle) return sink_.on_probe(*found, came_back);
    if (clock_.now() > deadline) {
      if (came_back) return fail(ErrorCode::kProbeLost, "it did not come back");
      return tl::unexpected(link_.not_found());
    }
    clock_.sleep_for(config_.poll_period);
  }
  return fail(ErrorCode::kCancelled);
}

Result<proto::Status> LiveFeed::fresh_status(const std::stop_token& stop) {
  ENAMEL_TRY(take_input());
  const HostTime deadline = clock_.now() + kStatusTimeout;
  const std::optional<proto::Status> before = link_.last_status();
  while (!stop.stop_requested() && clock_.now() < deadline) {
    ENAMEL_TRY(take_input());
    const auto& now = link_.last_status();
    if (now && (!before || now->seq != before->seq)) return *now;
    link_.wait_data(config_.poll_period);
  }
  return fail(stop.stop_requested() ? ErrorCode::kCancelled : ErrorCode::kProbeLost, "the probe says nothing");
}

// A probe in its self-test refuses; what counts is that it becomes READY. One that was started anew meanwhile, or that
// had not heard from here for as long as its lease, knows no session any more.
Result<void> LiveFeed::ask_to_warm_up(const std::stop_token& stop) {
  const auto reply = link_.command(proto::Opcode::kWarmup);
  if (reply || reply.error().code != ErrorCode::kProbeRefused) return {};
  log::debug(kModule, "WARMUP: {}", reply.error().detail);
  return take_lease(stop);
}

// A tip takes up to two minutes to warm up; the probe itself ends what takes longer.
Result<void> LiveFeed::wait_ready(const std::stop_token& stop) {
  HostTime deadline = clock_.now() + config_.find_timeout, ask_at = clock_.now();
  bool warming = false;
  while (!stop.stop_requested()) {
    ENAMEL_TRY(take_input());
    if (!link_.alive()) return fail(ErrorCode::kProbeLost, "while it became ready");
    const auto& status = link_.last_status();
    if (status && ready(status->state)) return {};
    if (status && status->state == proto::ProbeState::kWarmup) {
      deadline = clock_.now() + config_.find_timeout;
      if (!std::exchange(warming, true)) enter(state_, "the probe is warming up");
    }
    if (clock_.now() >= ask_at) {
      ask_at = clock_.now() + kAskAgain;
      ENAMEL_TRY(ask_to_warm_up(stop));
    }
    if (clock_.now() > deadline) {
      return fail(ErrorCode::kProbeRefused, "the probe is " + std::string(status ? name_of(status->state) : "silent") +
                                                " and does not become READY");
    }
    link_.wait_data(config_.poll_period);
  }
  return fail(ErrorCode::kCancelled);
}

// A host that was killed a moment ago holds the probe until its lease has run out.
Result<void> LiveFeed::take_lease(const std::stop_token& stop) {
  const HostTime deadline = clock_.now() + kLeaseOfAnother;
  for (;;) {
    const auto opened = link_.command(proto::Opcode::kSessionOpen);
    if (opened) return {};
    const bool again = opened.error().code == ErrorCode::kProbeRefused && clock_.now() < deadline;
    if (!again || stop.stop_requested()) return tl::unexpected<Error>(opened.error());
    enter(state_, "another host holds the probe: waiting for it to let go");
    clock_.sleep_for(kAskForLease);
  }
}

Result<void> LiveFeed::open_session(const std::stop_token& stop) {
  started_ = false;
  exposure_asked_us_ = 0;
  const std::uint32_t seq_before = link_.last_status() ? link_.last_status()->seq : 0;
  ENAMEL_TRY(take_lease(stop));
  ENAMEL_TRY_ASSIGN(const proto::Status status, fresh_status(stop));
  // Counters of our session that go on are those of the life before; a probe that was restarted knows no session yet.
  if (ever_started_ && (status.session_id != config_.session_id || status.seq < seq_before)) sink_.on_restart();
  if (!ready(status.state)) ENAMEL_TRY(wait_ready(stop));
  // Counters of the session before ours, of a host that was killed, are told as they end: nothing of it is under way.
  const HostTime deadline = clock_.now() + config_.close_within;
  while (link_.last_status()->session_id != config_.session_id && !at_rest(*link_.last_status()) &&
         clock_.now() < deadline) {
    link_.wait_data(config_.poll_period);
    ENAMEL_TRY(take_input());
  }
  enter(FeedState::kPaused);
  return {};
}

Result<void> LiveFeed::follow_wish() {
  const bool wanted = scanning_wanted();
  if (wanted && state_ != FeedState::kScanning) {
    ENAMEL_TRY(link_.command(proto::Opcode::kScanStart, {config_.session_id}));
    started_ = ever_started_ = true;
    resting_since_.reset();
    enter(FeedState::kScanning);
  } else if (!wanted && state_ == FeedState::kScanning) {
    ENAMEL_TRY(link_.command(proto::Opcode::kScanPause));
    enter(FeedState::kPaused);
  }
  return state_ == FeedState::kScanning ? follow_exposure() : Result<void>();
}

/// What the probe refuses is not asked again: the scan goes on as it is exposed.
Result<void> LiveFeed::follow_exposure() {
  const std::uint32_t wanted_us = exposure_wanted_us_.load(std::memory_order_acquire);
  if (wanted_us == exposure_asked_us_) return {};
  const auto reply = link_.command(proto::Opcode::kSetExposure, {wanted_us});
  if (!reply && reply.error().code != ErrorCode::kProbeRefused) return tl::unexpected<Error>(reply.error());
  exposure_asked_us_ = wanted_us;
  sink_.on_exposure(wanted_us, reply ? Result<void>() : Result<void>(tl::unexpected<Error>(reply.error())));
  return {};
}

Result<void> LiveFeed::take_input() {
  ENAMEL_TRY_ASSIGN(auto input, link_.poll());
  const HostTime now = clock_.now();
  for (auto& burst : input.bursts) sink_.on_burst(std::move(burst), now);
  for (const auto& status : input.statuses) sink_.on_status(status);
  for (const auto& event : input.events) {
    sink_.on_event(event);
    if (event.code == proto::kEventSessionEnded && started_) ended_ = true;
    if (event.severity >= proto::Severity::kWarning) log::warn("probe", "{}", event.text);
  }
  return {};
}

// The probe finishes the burst under way before it stops, and the final counters come after it by another topic: wait
// until they say that nothing is on its way any more, and then for what is late.
void LiveFeed::close_session() {
  if (started_ && !ended_) {
    if (const auto reply = link_.command(proto::Opcode::kScanStop); !reply)
      log::warn(kModule, "{}", reply.error().detail);
  }
  const HostTime deadline = clock_.now() + config_.close_within;
  int quiet = 0;
  while (clock_.now() < deadline && quiet < 8) {
    link_.wait_data(config_.poll_period * 2);
    const auto before = link_.last_status() ? link_.last_status()->seq : 0;
    if (!take_input()) break;
    const auto& status = link_.last_status();
    quiet = (status && status->seq == before && at_rest(*status)) ? quiet + 1 : 0;
  }
  static_cast<void>(link_.command(proto::Opcode::kSessionClose));
  static_cast<void>(take_input());
}

bool LiveFeed::probe_left_scanning() {
  const auto& status = link_.last_status();
  // Of another session: killed and started anew so soon that its liveliness never lapsed.
  const bool resting = started_ && state_ == FeedState::kScanning && status &&
                       (status->session_id != config_.session_id || status->state != proto::ProbeState::kScanning);
  if (!resting) {
    resting_since_.reset();
    return false;
  }
  if (!resting_since_) resting_since_ = clock_.now();
  return clock_.now() - *resting_since_ > config_.left_scanning;
}

// A probe that answers again at once is asked again; one that refuses for good, or stays away, ends the scan.
Result<void> LiveFeed::come_back(const std::stop_token& stop, const Error& why) {
  log::warn(kModule, "{}", words(why));
  enter(FeedState::kLost, words(why));
  resting_since_.reset();
  const HostTime deadline = clock_.now() + config_.lost_timeout;
  for (;;) {
    ENAMEL_TRY(wait_for_probe(stop, true));
    if (ended_) return {};
    auto opened = open_session(stop);
    const bool again = !opened && opened.error().code == ErrorCode::kProbeLost && clock_.now() < deadline;
    if (!again) return opened;
    clock_.sleep_for(config_.poll_period);
  }
}

Result<void> LiveFeed::begin(const std::stop_token& stop) {
  enter(FeedState::kWaiting, "waiting for a probe");
  ENAMEL_TRY(wait_for_probe(stop, false));
  auto opened = open_session(stop);
  if (opened || opened.error().code != ErrorCode::kProbeLost) return opened;
  return come_back(stop, opened.error());
}

Result<void> LiveFeed::run(const std::stop_token& stop) {
  ENAMEL_TRY(begin(stop));
  while (!stop.stop_requested() && !ended_) {
    link_.wait_data(config_.poll_period);
    Result<void> step = take_input();
    if (step && !ended_) step = follow_wish();
    const bool asleep = step && probe_left_scanning();
    if (ended_ || (step && link_.alive() && !asleep)) continue;
    // Refused: the lease ran out before it was noticed here.
    if (!step && step.error().code != ErrorCode::kProbeLost && step.error().code != ErrorCode::kProbeRefused)
      return step;
    const Error lost{ErrorCode::kProbeLost, link_.probe() ? link_.probe()->serial : ""};
    if (auto back = come_back(stop, step ? lost : step.error()); !back) {
      if (back.error().code == ErrorCode::kCancelled) break;
      return back;
    }
  }
  close_session();
  enter(FeedState::kEnded);
  return {};
}

}  // namespace enamel::host
