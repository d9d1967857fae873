// Reads ahead from a BurstSource, so that rendering or unpacking does not disturb the simulated camera's pace.
#pragma once

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "firmware/device/sim/burst_source.hpp"

namespace enamel::fw {

/// Thread-safe for one consumer.
class BurstFeed {
 public:
  /// depth 0: no thread, poll() reads the source itself (tests in virtual time).
  BurstFeed(std::unique_ptr<BurstSource> source, std::size_t depth);
  ~BurstFeed();
  BurstFeed(const BurstFeed&) = delete;
  BurstFeed& operator=(const BurstFeed&) = delete;

  enum class State { kReady, kNotYet, kEnd };
  struct Polled {
    State state = State::kNotYet;
    std::optional<SimBurst> burst;
  };
  /// Never waits when depth > 0. Errors: the source's, once; then kEnd.
  [[nodiscard]] Result<Polled> poll();
  /// Waits for the first burst. Errors: the source's; kEmptyInput.
  [[nodiscard]] Result<void> wait_first();
  /// Needs a successful wait_first(). The first burst, still to be polled.
  [[nodiscard]] const SimBurst& first() const noexcept { return *first_; }
  [[nodiscard]] const std::string& rig_text() const noexcept { return rig_text_; }
  [[nodiscard]] bool simulated() const noexcept { return simulated_; }
  [[nodiscard]] Nanoseconds lateness() const noexcept { return lateness_; }

 private:
  void read_ahead(const std::stop_token& stop);

  std::unique_ptr<BurstSource> source_;
  const std::size_t depth_;
  const std::string rig_text_;
  const bool simulated_;
  const Nanoseconds lateness_;
  std::optional<SimBurst> first_;
  bool first_taken_ = false;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Result<std::optional<SimBurst>>> queue_;
  bool ended_ = false;
  std::jthread thread_;
};

}  // namespace enamel::fw
