// Heater of the tip window: warm glass does not fog.
#pragma once

#include <cstdint>

namespace enamel::fw {

/// Thread-safe.
class Heater {
 public:
  virtual ~Heater() = default;
  /// Of full power, 0 … 1000. Off when the object goes.
  virtual void set_power(std::uint16_t permille) noexcept = 0;
};

}  // namespace enamel::fw
