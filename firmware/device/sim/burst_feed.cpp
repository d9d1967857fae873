#include "firmware/device/sim/burst_feed.hpp"

#include <pthread.h>

#include <utility>

namespace enamel::fw {

BurstFeed::BurstFeed(std::unique_ptr<BurstSource> source, std::size_t depth)
    : source_(std::move(source)),
      depth_(depth),
      rig_text_(source_->rig_text()),
      simulated_(source_->simulated()),
      lateness_(source_->lateness()) {}

BurstFeed::~BurstFeed() {
  thread_.request_stop();
  changed_.notify_all();
}

Result<void> BurstFeed::wait_first() {
  ENAMEL_TRY_ASSIGN(first_, source_->next());
  if (!first_) return fail(ErrorCode::kEmptyInput, "the source of simulated light has no burst");
  if (depth_ > 0) {
    thread_ = std::jthread([this](const std::stop_token& stop) { read_ahead(stop); });
    (void)pthread_setname_np(thread_.native_handle(), "sim-source");
  }
  return {};
}

void BurstFeed::read_ahead(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    auto next = source_->next();
    const bool last = !next || !*next;
    std::unique_lock lock(mutex_);
    queue_.push_back(std::move(next));
    if (last) return;
    changed_.wait(lock, stop, [&] { return queue_.size() < depth_; });
  }
}

Result<BurstFeed::Polled> BurstFeed::poll() {
  if (first_ && !first_taken_) {
    first_taken_ = true;
    return Polled{State::kReady, std::exchange(*first_, SimBurst{})};
  }
  if (ended_) return Polled{State::kEnd, std::nullopt};
  Result<std::optional<SimBurst>> next = std::optional<SimBurst>{};
  if (depth_ == 0) {
    next = source_->next();
  } else {
    const std::lock_guard lock(mutex_);
    if (queue_.empty()) return Polled{State::kNotYet, std::nullopt};
    next = std::move(queue_.front());
    queue_.pop_front();
    changed_.notify_all();
  }
  ended_ = !next || !*next;
  if (!next) return tl::unexpected(std::move(next).error());
  if (!*next) return Polled{State::kEnd, std::nullopt};
  return Polled{State::kReady, std::move(*next)};
}

}  // namespace enamel::fw
