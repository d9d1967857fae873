// Sends bursts from a thread of its own behind a bounded queue that lets the oldest go: the capture side never waits
// for the link. What goes is counted as QUEUE_FULL, before it has a burst_seq.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <thread>
#include <vector>

#include "firmware/acquire/burst_ledger.hpp"
#include "firmware/publish/burst_builder.hpp"
#include "protocol/base/clock.hpp"

namespace enamel::fw {

class BurstSink {
 public:
  virtual ~BurstSink() = default;
  /// May wait for the link. On error nothing was sent.
  [[nodiscard]] virtual Result<void> write(const proto::Burst& burst) = 0;
};

struct PublisherConfig {
  std::size_t queue_depth = 3;
  BurstBuilderConfig burst;
};

struct PublisherRates {
  std::uint16_t burst_rate_chz = 0;  ///< bursts written during the last two seconds
  std::uint16_t write_ms_p99 = 0;    ///< of the last 128 writes
};

/// push() and rates() from any thread.
class Publisher {
 public:
  Publisher(BurstSink& sink, BurstLedger& ledger, Clock& clock, const PublisherConfig& config);
  ~Publisher();  ///< bursts still queued are counted as QUEUE_FULL
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;

  /// Never waits.
  void push(CapturedBurst burst);
  [[nodiscard]] PublisherRates rates() const;

 private:
  void run(const std::stop_token& stop);
  void publish(CapturedBurst captured);
  void note_write(HostTime begin, HostTime end);

  BurstSink& sink_;
  BurstLedger& ledger_;
  Clock& clock_;
  const PublisherConfig config_;
  ScanTag session_;  ///< publisher thread
  std::uint64_t next_seq_ = 0;

  mutable std::mutex mutex_;
  std::condition_variable_any filled_;
  std::deque<CapturedBurst> queue_;
  std::deque<HostTime> written_at_;
  std::deque<std::int64_t> write_ns_;
  std::jthread thread_;  ///< last member: stops before the others go
};

}  // namespace enamel::fw
