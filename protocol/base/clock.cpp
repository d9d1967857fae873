#include "protocol/base/clock.hpp"

#include <time.h>

#include <thread>

#include "protocol/base/slept.hpp"
#include "protocol/base/utc.hpp"

namespace enamel {

HostTime SteadyClock::now() const {
  return host_time(
      std::chrono::duration_cast<Nanoseconds>(std::chrono::steady_clock::now().time_since_epoch()).count());
}

WallTime wall_time() { return std::chrono::system_clock::now(); }

void SteadyClock::sleep_until(HostTime t) {
  const Nanoseconds left = t - now();
  if (left.count() > 0) std::this_thread::sleep_for(left);
}

void ManualClock::sleep_until(HostTime t) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return now() >= t; });
}

void ManualClock::advance(Nanoseconds d) {
  {
    const std::lock_guard lock(mutex_);
    now_ns_.fetch_add(d.count(), std::memory_order_acq_rel);
  }
  changed_.notify_all();
}

Nanoseconds slept() noexcept {
  timespec boottime{}, monotonic{};
  static_cast<void>(::clock_gettime(CLOCK_MONOTONIC, &monotonic));
  static_cast<void>(::clock_gettime(CLOCK_BOOTTIME, &boottime));
  return std::chrono::seconds{boottime.tv_sec - monotonic.tv_sec} +
         std::chrono::nanoseconds{boottime.tv_nsec - monotonic.tv_nsec};
}

}  // namespace enamel
