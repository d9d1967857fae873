// How far the sensor's stamp lies behind the end of exposure: measured at start-up, because drivers disagree about what
// the stamp means.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "protocol/base/time.hpp"

namespace enamel::fw {

/// The upper one of two. Not of nothing.
[[nodiscard]] std::int64_t median_of(std::vector<std::int64_t> values);

struct StampDelay {
  Nanoseconds median{};
  Nanoseconds mad{};  ///< median absolute deviation
};

/// Pure. Feed strobes and frames in order of time; the strobe of a frame is the last one before its stamp.
class DelayCalibration {
 public:
  explicit DelayCalibration(std::size_t frames) : wanted_(frames) {}
  void on_strobe(DeviceTime t);
  void on_frame(DeviceTime t_sensor, std::uint32_t exposure_us);
  [[nodiscard]] bool complete() const noexcept { return delays_.size() >= wanted_; }
  /// Nullopt before complete().
  [[nodiscard]] std::optional<StampDelay> result() const;

 private:
  std::size_t wanted_;
  std::vector<DeviceTime> strobes_;
  std::vector<std::int64_t> delays_;
};

}  // namespace enamel::fw
