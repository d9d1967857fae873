// What a camera back end needs of libcamera, and no more: a stream of fixed format, buffers, requests. The real one is
// LibcameraSource; tests have a fake, for what no driver in reach can be made to do.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "firmware/hal/camera.hpp"
#include "protocol/base/result.hpp"
#include "protocol/base/time.hpp"

namespace enamel::fw {

struct StreamFormat {
  int width = 0;
  int height = 0;
  int bit_depth = 8;
  PixelFormat pixels = PixelFormat::kRaw8;
  std::size_t stride = 0;  ///< bytes from a row to the next: never width alone, drivers pad
};

/// Set by hand, all of them: auto-exposure is off. Where a driver has no such control, its frames tell what was used.
struct CameraControls {
  std::uint32_t exposure_us = 3776;
  std::uint32_t analogue_gain_q8 = 256;
  Nanoseconds frame_period{4'004'000};
};

struct Completion {
  int slot = 0;
  FrameStatus status = FrameStatus::kSuccess;
  std::uint32_t sequence = 0;
  std::int64_t stamp_ns = 0;  ///< CLOCK_MONOTONIC or CLOCK_BOOTTIME: drivers disagree
  std::optional<std::uint32_t> exposure_us;
  std::optional<std::uint32_t> analogue_gain_q8;
};

/// Hears of requests that are done, on a thread of the source's: must neither wait nor allocate.
class CompletionSink {
 public:
  virtual ~CompletionSink() = default;
  virtual void completed(const Completion& completion) noexcept = 0;
  virtual void disconnected() noexcept = 0;
};

/// start(), stop() and queue() are called by one thread at a time. The sink must outlive stop(), and holds no lock
/// while it is called that the caller of stop() holds.
class RequestSource {
 public:
  virtual ~RequestSource() = default;
  [[nodiscard]] virtual const StreamFormat& format() const = 0;
  /// Buffers, one request each.
  [[nodiscard]] virtual int slots() const = 0;
  /// Of a slot's buffer; valid as long as the source lives.
  [[nodiscard]] virtual std::span<const std::uint8_t> memory(int slot) const = 0;
  /// Errors: kCamera.
  [[nodiscard]] virtual Result<void> start(const CameraControls& controls, CompletionSink& sink) = 0;
  /// Completes what is queued as kCancelled before it returns.
  virtual void stop() noexcept = 0;
  /// `change`: controls that travel with this request. Errors: kCamera.
  [[nodiscard]] virtual Result<void> queue(int slot, const std::optional<CameraControls>& change) = 0;
};

}  // namespace enamel::fw
