// The one seam between the probe's program and what it runs on: the twin and recordings (device/sim) or a board
// (device/linux).
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "firmware/hal/hardware.hpp"
#include "firmware/hal/heater.hpp"
#include "firmware/hal/watchdog.hpp"

namespace enamel::fw {

/// Time that a slow source or machine cost a simulated device: everything later moved by it.
struct StretchCount {
  std::uint64_t times = 0;
  Nanoseconds total{};
};

/// Called with each part that is open, in order, and what it is.
using PartHandler = std::function<void(const std::string& part, const std::string& what)>;

/// Everything a probe is made of. Thread-safety: that of the single parts (hal).
class Device {
 public:
  virtual ~Device() = default;
  [[nodiscard]] virtual Hardware hardware() noexcept = 0;
  /// As a person would call it; ends with SIMULATED where the light never was, and pictures and exports then say so.
  [[nodiscard]] virtual std::string model() const = 0;
  /// rig.json of the calibration in force, byte for byte.
  [[nodiscard]] virtual const std::string& rig_text() const = 0;
  /// How far its sensor's stamps may scatter (median absolute deviation) and still be trusted.
  [[nodiscard]] virtual Nanoseconds max_stamp_spread() const { return kUsualStampSpread; }
  /// Null: this device has none.
  [[nodiscard]] virtual Heater* heater() noexcept { return nullptr; }
  [[nodiscard]] virtual Watchdog* watchdog() noexcept { return nullptr; }
  /// How much later than a camera's its frames come, at most; a pause waits for the burst under way so much longer.
  [[nodiscard]] virtual Nanoseconds lateness() const { return Nanoseconds{0}; }
  /// An acquisition that waits longer for a frame hangs.
  [[nodiscard]] virtual Nanoseconds max_silence() const { return Nanoseconds{2'000'000'000}; }
  /// Hardware is never stretched.
  [[nodiscard]] virtual StretchCount stretched() const { return {}; }
};

}  // namespace enamel::fw
