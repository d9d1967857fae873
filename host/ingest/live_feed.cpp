#include "host/ingest/live_feed.hpp"

#include <cstdint>
#include <numeric>

#include "protocol/base/log.hpp"

namespace enamel::host {

namespace {

constexpr const char* kModule = "ingest";
constexpr Nanoseconds kLongestClose{1'000'000'000};  ///< more than twice what a probe takes to finish a burst

std::string words(const Error& error) { return error.message(); }

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
    const bool present = found && (!came_back || link_.alive());
    if (present && !first_seen) first_seen = clock_.now();
    if (present && clock_.now() - *first_seen >= config_.settle) return sink_.on_probe(*found, came_back);
    if (clock_.now() > deadline) {
      return fail(came_back ? ErrorCode::kProbeLost : ErrorCode::kProbeNotFound,
                  came_back ? "it did not come back" : "none answered in time");
    }
    clock_.sleep_for(config_.poll_period);
  }
  return fail(ErrorCode::kCancelled);
}

Result<void> LiveFeed::wait_ready(const std::stop_token& stop) {
  const HostTime deadline = clock_.now() + config_.find_timeout;
  while (!stop.stop_requested()) {
    ENAMEL_TRY(take_input());
    const auto& status = link_.last_status();
    if (status && status->state == proto::ProbeState::kReady) return {};
    if (clock_.now() > deadline) {
      return fail(ErrorCode::kProbeRefused, "the probe is " + std::string(status ? name_of(status->state) : "silent") +
                                                " and does not become READY");
    }
    link_.wait_data(config_.poll_period);
  }
  return fail(ErrorCode::kCancelled);
}

Result<void> LiveFeed::open_session(const std::stop_token& stop) {
  started_ = false;
  ENAMEL_TRY(link_.command(proto::Opcode::kSessionOpen));
  ENAMEL_TRY(take_input());
  const auto& status = link_.last_status();
  if (!status || status->state != proto::ProbeState::kReady) {
    // A probe that is already warming up refuses; what counts is that it becomes READY.
    if (const auto reply = link_.command(proto::Opcode::kWarmup); !reply) {
      log::debug(kModule, "WARMUP: {}", reply.error().detail);
    }
    ENAMEL_TRY(wait_ready(stop));
  }
  enter(FeedState::kPaused);
  return {};
}

Result<void> LiveFeed::follow_wish() {
  const bool wanted = scanning_wanted();
  if (wanted && state_ != FeedState::kScanning) {
    ENAMEL_TRY(link_.command(proto::Opcode::kScanStart, {config_.session_id}));
    started_ = true;
    enter(FeedState::kScanning);
  } else if (!wanted && state_ == FeedState::kScanning) {
    ENAMEL_TRY(link_.command(proto::Opcode::kScanPause));
    enter(FeedState::kPaused);
  }
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
  const HostTime deadline = clock_.now() + kLongestClose;
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

Result<void> LiveFeed::run(const std::stop_token& stop) {
  enter(FeedState::kWaiting, "waiting for a probe");
  ENAMEL_TRY(wait_for_probe(stop, false));
  ENAMEL_TRY(open_session(stop));
  while (!stop.stop_requested() && !ended_) {
    link_.wait_data(config_.poll_period);
    Result<void> step = take_input();
    if (step) step = follow_wish();
    if (link_.alive() && step) continue;
    if (!step && step.error().code != ErrorCode::kProbeLost) return step;
    const Error lost{ErrorCode::kProbeLost, link_.probe() ? link_.probe()->serial : ""};
    log::warn(kModule, "{}", words(lost));
    enter(FeedState::kLost, words(lost));
    if (auto back = wait_for_probe(stop, true); !back) {
      if (back.error().code == ErrorCode::kCancelled) break;
      return back;
    }
    ENAMEL_TRY(open_session(stop));
  }
  close_session();
  enter(FeedState::kEnded);
  return {};
}

}  // namespace enamel::host
