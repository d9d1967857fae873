#include "firmware/publish/publisher.hpp"

#include <pthread.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "protocol/base/log.hpp"

namespace enamel::fw {
namespace {

using proto::DropReason;

constexpr std::size_t kWriteSamples = 128;
constexpr Nanoseconds kRateWindow{2'000'000'000};

}  // namespace

Publisher::Publisher(BurstSink& sink, BurstLedger& ledger, Clock& clock, const PublisherConfig& config)
    : sink_(sink), ledger_(ledger), clock_(clock), config_(config) {
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  (void)pthread_setname_np(thread_.native_handle(), "fw-publish");
}

Publisher::~Publisher() {
  thread_.request_stop();
  thread_.join();
  for (const CapturedBurst& left : queue_) ledger_.drop(left.session, DropReason::kQueueFull);
}

void Publisher::push(CapturedBurst burst) {
  std::optional<ScanTag> dropped;
  {
    const std::lock_guard lock(mutex_);
    if (queue_.size() >= config_.queue_depth) {
      dropped = queue_.front().session;
      queue_.pop_front();
    }
    queue_.push_back(std::move(burst));
  }
  filled_.notify_one();
  if (dropped) ledger_.drop(*dropped, DropReason::kQueueFull);
}

void Publisher::run(const std::stop_token& stop) {
  for (;;) {
    std::unique_lock lock(mutex_);
    if (!filled_.wait(lock, stop, [&] { return !queue_.empty(); }) || stop.stop_requested()) return;
    CapturedBurst captured = std::move(queue_.front());
    queue_.pop_front();
    lock.unlock();
    publish(std::move(captured));
  }
}

void Publisher::publish(CapturedBurst captured) {
  const ScanTag session = captured.session;
  if (!(session == session_)) {
    session_ = session;
    next_seq_ = 0;
  }
  auto burst = build_burst(std::move(captured), config_.burst);
  if (!burst) {
    log::error("publish", "{}", burst.error().message());
    return ledger_.drop(session, DropReason::kEncode);
  }
  const HostTime begin = clock_.now();
  burst->burst_seq = next_seq_;
  burst->t_publish_ns = static_cast<std::uint64_t>(std::max<std::int64_t>(0, to_ns(begin)));
  if (auto written = sink_.write(*burst); !written) {
    log::warn("publish", "burst {}: {}", burst->burst_index, written.error().message());
    return ledger_.drop(session, DropReason::kWriteFail);
  }
  ++next_seq_;
  note_write(begin, clock_.now());
  ledger_.emit(session);
}

void Publisher::note_write(HostTime begin, HostTime end) {
  const std::lock_guard lock(mutex_);
  written_at_.push_back(end);
  write_ns_.push_back((end - begin).count());
  if (write_ns_.size() > kWriteSamples) write_ns_.pop_front();
  while (!written_at_.empty() && written_at_.front() < end - kRateWindow) written_at_.pop_front();
}

PublisherRates Publisher::rates() const {
  const HostTime now = clock_.now();
  const std::lock_guard lock(mutex_);
  PublisherRates rates;
  const auto first =
      std::find_if(written_at_.begin(), written_at_.end(), [&](HostTime t) { return t >= now - kRateWindow; });
  const auto n = std::distance(first, written_at_.end());
  if (n > 1) {
    const double seconds = static_cast<double>((written_at_.back() - *first).count()) * 1e-9;
    if (seconds > 0) {
      rates.burst_rate_chz =
          static_cast<std::uint16_t>(std::min(65535.0, static_cast<double>(n - 1) / seconds * 100.0));
    }
  }
  if (!write_ns_.empty()) {
    std::vector<std::int64_t> sorted(write_ns_.begin(), write_ns_.end());
    std::sort(sorted.begin(), sorted.end());
    const std::int64_t p99 = sorted[(sorted.size() * 99 - 1) / 100];
    rates.write_ms_p99 = static_cast<std::uint16_t>(std::min<std::int64_t>(65535, (p99 + 999'999) / 1'000'000));
  }
  return rates;
}

}  // namespace enamel::fw
