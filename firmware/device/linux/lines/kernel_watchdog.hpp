// The board's watchdog by the kernel's /dev/watchdog.
#pragma once

#include <memory>
#include <string>

#include "firmware/device/linux/lines/gpio_chip.hpp"
#include "firmware/hal/watchdog.hpp"

namespace enamel::fw {

class KernelWatchdog final : public Watchdog {
 public:
  /// Armed from here on. Errors: kBoardLine with the remedy.
  [[nodiscard]] static Result<std::unique_ptr<KernelWatchdog>> open(const std::string& path, int seconds);
  /// `armed`: of an open watchdog.
  explicit KernelWatchdog(LineHandle armed) noexcept : fd_(std::move(armed)) {}
  ~KernelWatchdog() override;
  void feed() noexcept override;

 private:
  LineHandle fd_;
};

}  // namespace enamel::fw
