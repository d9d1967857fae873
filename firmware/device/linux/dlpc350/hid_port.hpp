// A controller on USB, as a human interface device.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "protocol/base/result.hpp"
#include "protocol/base/time.hpp"

namespace enamel::fw {

/// Without its report id, which is 0.
using HidReport = std::array<std::uint8_t, 64>;

/// One thread. Errors: kProjector with the remedy.
class HidPort {
 public:
  virtual ~HidPort() = default;
  [[nodiscard]] virtual Result<void> write(const HidReport& report) = 0;
  /// Bytes of the next report; 0: none came within `limit`.
  [[nodiscard]] virtual Result<std::size_t> read(HidReport& report, Nanoseconds limit) = 0;
};

/// A LightCrafter 4500 at `path`, /dev/hidrawN; "any": the first one found. The kernel ends a write that hangs after
/// 5 s. Errors: kProjector with the remedy (no such device, no permission, a device of another type).
[[nodiscard]] Result<std::unique_ptr<HidPort>> open_hidraw(const std::string& path);

}  // namespace enamel::fw
