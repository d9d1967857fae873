// The tip's heater behind a PWM output of the kernel: /sys/class/pwm/pwmchipN/pwmM.
#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "firmware/hal/heater.hpp"
#include "protocol/base/result.hpp"

namespace enamel::fw {

class PwmHeater final : public Heater {
 public:
  /// Exports the output if need be and leaves it at zero. Errors: kBoardThermal with the remedy.
  [[nodiscard]] static Result<std::unique_ptr<PwmHeater>> open(const std::string& path, int period_us);
  ~PwmHeater() override;
  void set_power(std::uint16_t permille) noexcept override;

 private:
  PwmHeater(std::string path, long period_ns)
      : duty_(path + "/duty_cycle"), enable_(path + "/enable"), period_ns_(period_ns) {}

  std::string duty_, enable_;
  long period_ns_;
  std::atomic<int> permille_{-1};  ///< written last; -1: unknown
};

}  // namespace enamel::fw
