// When to draw next. Software rendering runs on the cores that the pipeline needs, which is seen by what it sheds.
#pragma once

#include <algorithm>
#include <cstdint>

#include "protocol/base/time.hpp"

namespace enamel::view {

class FramePacer {
 public:
  /// Shares of the time that drawing may take, above 0 and at most 1: as a rule, and while bursts are shed.
  struct Shares {
    double usual = 1, yielding = 1;
  };
  /// max_fps > 0.
  FramePacer(double max_fps, const Shares& shares)
      : period_ns_(static_cast<std::int64_t>(1e9 / std::clamp(max_fps, 0.1, 1000.0))), shares_(shares) {}

  /// Bursts shed so far, of the frame that is drawn now.
  void told(std::uint64_t shed, HostTime now) noexcept {
    if (shed > shed_) yields_until_ = now + kYield;
    shed_ = shed;
  }
  void drawn(HostTime began, HostTime ended) noexcept {
    const double share = std::clamp(began < yields_until_ ? shares_.yielding : shares_.usual, 0.01, 1.0);
    const double busy_ns = static_cast<double>((ended - began).count());
    const auto rest_ns = static_cast<std::int64_t>(std::max(0.0, busy_ns) / share);
    due_ = began + Nanoseconds(std::max(period_ns_, rest_ns));
  }
  [[nodiscard]] HostTime due() const noexcept { return due_; }

 private:
  static constexpr Nanoseconds kYield{2'000'000'000};  ///< chosen: a queue is worked off by then

  std::int64_t period_ns_;
  Shares shares_;
  std::uint64_t shed_ = 0;
  HostTime due_{}, yields_until_{};
};

}  // namespace enamel::view
