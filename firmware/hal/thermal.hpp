// Temperatures of the probe, 0.01 degC.
#pragma once

#include <cstdint>
#include <optional>

namespace enamel::fw {

/// A sensor that is open, shorted or implausible (below 0 or above 80 degC) has no value.
struct Temperatures {
  std::optional<std::int16_t> tip_cc;
  std::optional<std::int16_t> led_cc;
  std::optional<std::int16_t> soc_cc;
  std::optional<std::int16_t> optics_cc;  ///< of the measuring head: travels with each burst
};

/// Thread-safe.
class Thermal {
 public:
  virtual ~Thermal() = default;
  [[nodiscard]] virtual Temperatures read() const = 0;
};

}  // namespace enamel::fw
