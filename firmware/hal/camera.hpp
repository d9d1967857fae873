// Narrow interfaces to the probe's hardware. Implementations: firmware/device/sim (twin and capture player) and
// firmware/device/linux. One owner thread each, unless stated.
#pragma once

#include <cstdint>

#include "firmware/hal/pixels.hpp"
#include "protocol/base/result.hpp"
#include "protocol/base/time.hpp"

namespace enamel::fw {

enum class FrameStatus : std::uint8_t { kSuccess, kStartup, kError, kCancelled };

/// One sensor frame, in order of completion. `t_sensor` is the sensor's stamp: end of exposure plus a constant delay.
struct CameraFrame {
  std::uint32_t sensor_seq = 0;
  FrameStatus status = FrameStatus::kSuccess;
  DeviceTime t_sensor{};
  std::uint32_t exposure_us = 0;
  std::uint32_t analogue_gain_q8 = 256;
  int width = 0;
  int height = 0;
  int bit_depth = 8;
  PixelFormat format = PixelFormat::kRaw8;
  PixelLoan pixels;  ///< rows top-down
};

struct CameraMode {
  int width = 0;
  int height = 0;
  int bit_depth = 8;
  Nanoseconds frame_period{};
  std::uint32_t exposure_us = 0;
};

/// Median absolute deviation of a sensor's stamps that a board's drivers keep.
inline constexpr Nanoseconds kUsualStampSpread{100'000};

class Camera {
 public:
  virtual ~Camera() = default;
  [[nodiscard]] virtual CameraMode mode() const = 0;
  [[nodiscard]] virtual Result<void> start() = 0;
  virtual void stop() noexcept = 0;
  /// Waits for the next frame. Errors: kCamera on time-out or disconnection, kCancelled after stop() or at the end of a
  /// finite source.
  [[nodiscard]] virtual Result<CameraFrame> next_frame() = 0;
  /// Bursts that begin from now on are exposed so long; 0: as mode() says. From any thread. Errors: kHal when this
  /// camera cannot, kConfigValue with its limits.
  [[nodiscard]] virtual Result<void> set_exposure(std::uint32_t) {
    return fail(ErrorCode::kHal, "its exposure is bound to the projector's pattern and cannot be changed");
  }
  /// How often it was stopped and started again inside next_frame(): what was measured of its stamps holds no more.
  [[nodiscard]] virtual std::uint64_t restarts() const { return 0; }
};

}  // namespace enamel::fw
