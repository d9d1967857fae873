// The only place that reads a clock. Everything that waits or stamps takes a Clock& at construction.
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>

#include "protocol/base/time.hpp"

namespace enamel {

/// Monotonic time source. All members are thread-safe.
class Clock {
 public:
  virtual ~Clock() = default;
  [[nodiscard]] virtual HostTime now() const = 0;
  /// Returns at `t` or later.
  virtual void sleep_until(HostTime t) = 0;
  void sleep_for(Nanoseconds d) { sleep_until(now() + d); }
};

class SteadyClock final : public Clock {
 public:
  [[nodiscard]] HostTime now() const override;
  void sleep_until(HostTime t) override;
};

/// Time that only moves when a test moves it; sleepers wake when it passes their time.
class ManualClock final : public Clock {
 public:
  explicit ManualClock(HostTime start = host_time(0)) : now_ns_(to_ns(start)) {}
  [[nodiscard]] HostTime now() const override { return host_time(now_ns_.load(std::memory_order_acquire)); }
  void sleep_until(HostTime t) override;
  void advance(Nanoseconds d);

 private:
  std::atomic<std::int64_t> now_ns_;
  std::mutex mutex_;
  std::condition_variable changed_;
};

}  // namespace enamel
