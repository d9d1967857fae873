// A controller on an I2C bus.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "protocol/base/result.hpp"

namespace enamel::fw {

/// One thread. Every call ends within its deadline, also when the bus hangs.
class I2cBus {
 public:
  virtual ~I2cBus() = default;
  /// Errors: kProjector.
  [[nodiscard]] virtual Result<void> write(std::span<const std::uint8_t> bytes) = 0;
  /// Writes, then reads in a transaction of its own: DLPC controllers do not take a repeated start. Errors: kProjector.
  [[nodiscard]] virtual Result<void> write_read(std::span<const std::uint8_t> bytes,
                                                std::span<std::uint8_t> answer) = 0;
};

/// /dev/i2c-N by I2C_RDWR. `address`: seven bits. Errors: kProjector with the remedy (no such bus, no permission, bus
/// busy, no answer).
[[nodiscard]] Result<std::unique_ptr<I2cBus>> open_i2c(const std::string& path, std::uint8_t address);

}  // namespace enamel::fw
