// Temperatures and the LED's current as the kernel's hwmon and IIO drivers show them: one number a file.
#pragma once

#include <atomic>
#include <optional>
#include <string>

#include "firmware/device/linux/lines/gpio_chip.hpp"
#include "firmware/hal/light.hpp"
#include "firmware/hal/thermal.hpp"

namespace enamel::fw {

/// Files with milli-degrees Celsius; empty: there is no such sensor.
struct ThermalFiles {
  std::string tip;
  std::string led;
  std::string soc;
  std::string optics;
};

class SysfsThermal final : public Thermal {
 public:
  explicit SysfsThermal(ThermalFiles files) : files_(std::move(files)) {}
  [[nodiscard]] Temperatures read() const override;

 private:
  ThermalFiles files_;
};

/// LED enable by a GPIO line, current by a file with mA. A current that cannot be read counts as flowing: whoever asks
/// whether it is dark must not be told yes.
class LineLight final : public Light {
 public:
  LineLight(LineHandle enable, std::string current_file)
      : enable_(std::move(enable)), current_(std::move(current_file)) {}
  ~LineLight() override { set_enabled(false); }
  LineLight(const LineLight&) = delete;
  LineLight& operator=(const LineLight&) = delete;

  void set_enabled(bool on) noexcept override;
  [[nodiscard]] bool enabled() const noexcept override { return on_.load(std::memory_order_acquire); }
  [[nodiscard]] int sensed_ma() const noexcept override;

 private:
  LineHandle enable_;
  std::string current_;
  std::atomic<bool> on_{false};
};

}  // namespace enamel::fw
