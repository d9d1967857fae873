// When to draw next. Software rendering runs on the cores that the pipeline needs.
#pragma once

#include <algorithm>
#include <cstdint>

#include "protocol/base/time.hpp"

namespace enamel::view {

class FramePacer {
 public:
  /// max_fps > 0; 0 < max_busy_share <= 1 is the share of time that drawing may take.
  FramePacer(double max_fps, double max_busy_share)
      : period_ns_(static_cast<std::int64_t>(1e9 / std::clamp(max_fps, 0.1, 1000.0))),
        busy_share_(std::clamp(max_busy_share, 0.01, 1.0)) {}

  void drawn(HostTime began, HostTime ended) noexcept {
    const double busy_ns = static_cast<double>((ended - began).count());
    const auto rest_ns = static_cast<std::int64_t>(std::max(0.0, busy_ns) / busy_share_);
    due_ = began + Nanoseconds(std::max(period_ns_, rest_ns));
  }
  [[nodiscard]] HostTime due() const noexcept { return due_; }

 private:
  std::int64_t period_ns_;
  double busy_share_;
  HostTime due_{};
};

}  // namespace enamel::view
