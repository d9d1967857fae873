// Time that jumps to where someone wants to sleep: whole sessions run in no time, deterministically.
#pragma once

#include <algorithm>
#include <atomic>

#include "protocol/base/clock.hpp"

namespace enamel::fw::test {

class VirtualClock final : public Clock {
 public:
  [[nodiscard]] HostTime now() const override { return host_time(now_ns_.load(std::memory_order_acquire)); }
  void sleep_until(HostTime t) override {
    std::int64_t now_ns = now_ns_.load(std::memory_order_acquire);
    while (now_ns < to_ns(t) && !now_ns_.compare_exchange_weak(now_ns, to_ns(t))) {
    }
  }

 private:
  std::atomic<std::int64_t> now_ns_{1'000'000'000};
};

}  // namespace enamel::fw::test
