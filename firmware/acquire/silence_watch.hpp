// How long the acquisition has been at work without a sign of life. Pure; one thread.
#pragma once

#include <optional>

#include "firmware/acquire/acquisition_port.hpp"
#include "protocol/base/time.hpp"

namespace enamel::fw {

class SilenceWatch {
 public:
  void update(const AcquisitionReport& report, HostTime now) noexcept {
    const bool waits = report.phase == AcquisitionPhase::kRunning && report.beats == beats_;
    if (!waits || !heard_) heard_ = now;
    beats_ = report.beats;
    silence_ = now - *heard_;
  }
  /// Zero while nothing is asked of it.
  [[nodiscard]] Nanoseconds silence() const noexcept { return silence_; }

 private:
  std::uint64_t beats_ = 0;
  std::optional<HostTime> heard_;
  Nanoseconds silence_{};
};

}  // namespace enamel::fw
