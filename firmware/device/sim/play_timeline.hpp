// Maps a source's times to device time: differences are kept (divided by the speed), and what comes late moves
// everything after it, never silently.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "firmware/device/device.hpp"
#include "protocol/base/time.hpp"

namespace enamel::fw {

/// Exact at speed 1: integer differences are kept to the nanosecond. One thread.
class PlayTimeline {
 public:
  explicit PlayTimeline(double speed) : speed_(speed) {}

  [[nodiscard]] Nanoseconds scale(std::int64_t source_ns) const {
    if (speed_ == 1.0) return Nanoseconds{source_ns};
    return Nanoseconds{std::llround(static_cast<double>(source_ns) / speed_)};
  }
  [[nodiscard]] bool based() const noexcept { return base_.has_value(); }
  void rebase(std::int64_t source_ns, DeviceTime device) { base_ = Base{source_ns, device}; }
  void forget() noexcept { base_.reset(); }
  /// Needs based().
  [[nodiscard]] DeviceTime map(std::int64_t source_ns) const {
    return base_->device + scale(source_ns - base_->source_ns);
  }
  /// Moves all later times by `late`.
  void stretch(Nanoseconds late) {
    base_->device += late;
    ++count_.times;
    count_.total += late;
  }
  [[nodiscard]] StretchCount stretched() const noexcept { return count_; }

 private:
  struct Base {
    std::int64_t source_ns = 0;
    DeviceTime device{};
  };
  double speed_;
  std::optional<Base> base_;
  StretchCount count_;
};

}  // namespace enamel::fw
