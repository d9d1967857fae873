// LED enable line and its feedback.
#pragma once

namespace enamel::fw {

/// Thread-safe: anyone may switch the light off at any time.
class Light {
 public:
  virtual ~Light() = default;
  virtual void set_enabled(bool on) noexcept = 0;
  [[nodiscard]] virtual bool enabled() const noexcept = 0;
  /// Measured current, mA: what the LED does, not what it was told.
  [[nodiscard]] virtual int sensed_ma() const noexcept = 0;
};

}  // namespace enamel::fw
