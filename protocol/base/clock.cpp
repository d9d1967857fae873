#include "protocol/base/clock.hpp"

#include <fmt/chrono.h>

#include <thread>

#include "protocol/base/wall_time.hpp"

namespace enamel {

HostTime SteadyClock::now() const {
  return host_time(
      std::chrono::duration_cast<Nanoseconds>(std::chrono::steady_clock::now().time_since_epoch()).count());
}

WallTime wall_time() { return std::chrono::system_clock::now(); }

std::string to_utc_text(WallTime time) {
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(time.time_since_epoch());
  const auto whole = std::chrono::floor<std::chrono::seconds>(ms);
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", fmt::gmtime(std::time_t{whole.count()}), (ms - whole).count());
}

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

}  // namespace enamel
