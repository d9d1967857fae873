// Device clock to host clock from four-stamp exchanges (NTP): offset = ((t2 - t1) + (t3 - t4)) / 2, uncertain by half
// of the round trip. The exchange with the shortest round trip of the last sixteen counts; drift within them is far
// below that.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "protocol/base/time.hpp"

namespace enamel::host {

class ClockMap {
 public:
  /// t1, t4 host; t2, t3 device; ns.
  void add(std::int64_t t1, std::int64_t t2, std::int64_t t3, std::int64_t t4) {
    const std::int64_t round_trip = (t4 - t1) - (t3 - t2);
    if (round_trip < 0) return;  // not a possible exchange: a clock was stepped
    samples_[next_] = {round_trip, ((t2 - t1) + (t3 - t4)) / 2};
    next_ = (next_ + 1) % samples_.size();
  }

  [[nodiscard]] std::optional<HostTime> to_host(DeviceTime t) const {
    const Sample& best = shortest();
    if (best.round_trip_ns == kNone) return std::nullopt;
    return host_time(to_ns(t) - best.offset_ns);
  }

  /// Half of the shortest round trip; nullopt before the first exchange.
  [[nodiscard]] std::optional<Nanoseconds> uncertainty() const {
    const Sample& best = shortest();
    if (best.round_trip_ns == kNone) return std::nullopt;
    return Nanoseconds(best.round_trip_ns / 2);
  }

 private:
  static constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::max();
  struct Sample {
    std::int64_t round_trip_ns = kNone;
    std::int64_t offset_ns = 0;
  };
  [[nodiscard]] const Sample& shortest() const {
    const Sample* best = samples_.data();
    for (const Sample& s : samples_) {
      if (s.round_trip_ns < best->round_trip_ns) best = &s;
    }
    return *best;
  }

  std::array<Sample, 16> samples_{};
  std::size_t next_ = 0;
};

}  // namespace enamel::host
