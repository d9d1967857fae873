// What the probe's control asks of the acquisition, and what it hears back.
#pragma once

#include <cstdint>
#include <optional>

#include "firmware/acquire/burst_ledger.hpp"
#include "protocol/base/result.hpp"
#include "protocol/types/device.hpp"

namespace enamel::fw {

enum class AcquisitionPhase : std::uint8_t {
  kIdle,     ///< nothing asked for yet
  kRunning,  ///< at it, or draining
  kDone,     ///< as asked: measured, drained, aborted, or the limit of bursts reached
  kEnded,    ///< a finite source has no further burst
  kFailed,   ///< see `fault`
};

struct AcquisitionReport {
  AcquisitionPhase phase = AcquisitionPhase::kIdle;
  proto::ReplyStatus fault = proto::ReplyStatus::kOk;
  bool led_stuck = false;   ///< light where none should be: a safety matter, whatever the phase
  std::uint64_t beats = 0;  ///< signs of life, since the start: one a frame, or a failure to get one
};

/// One job at a time. Each returns at once; report() tells how it goes.
class AcquisitionPort {
 public:
  virtual ~AcquisitionPort() = default;
  /// Bursts until drain(), abort(), the limit or the end of the source.
  virtual void scan(ScanTag session, std::optional<std::uint64_t> limit) = 0;
  /// Projector ready and without a fault of its own, camera delivers, LED answers, dark is dark, thermistor sane.
  virtual void self_test() = 0;
  /// Measures the delay of the sensor's stamps.
  virtual void calibrate() = 0;
  /// No new burst; ends when the one under way is whole. Nothing is lost.
  virtual void drain() = 0;
  /// Ends now; a burst under way is given up. Returns when the job has let go of the hardware, or within 200 ms.
  virtual void abort() = 0;
  /// As Camera::set_exposure, whatever the job.
  [[nodiscard]] virtual Result<void> set_exposure(std::uint32_t exposure_us) = 0;
  [[nodiscard]] virtual AcquisitionReport report() const = 0;
};

}  // namespace enamel::fw
