// A projector's controller: what a board needs of any of them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "protocol/base/result.hpp"

namespace enamel::fw {

/// LEDs of an exposure.
inline constexpr std::uint8_t kRedLed = 1, kGreenLed = 2, kBlueLed = 4;

/// One exposure, us. Defaults: the true 8-bit sequence of a DLPC347x.
struct PatternTiming {
  std::uint32_t illum_us = 3464;
  std::uint32_t pre_us = 171;
  std::uint32_t post_us = 31;
  int bits = 8;
};

struct ProjectorLimits {
  std::uint16_t max_led_code = 400;  ///< the eye's ceiling
  std::uint8_t leds = kBlueLed;
};

/// What the controller is and how it does.
struct ControllerStatus {
  std::string type;               ///< "DLPC3470" …
  std::string version;            ///< of its software
  std::optional<double> celsius;  ///< nullopt: it has no sensor
  bool initialised = false;
  bool system_error = false;
  bool sequence_error = false;  ///< sensing sequence not usable
  bool sequence_abort = false;  ///< stopped inside a pattern set
  bool watchdog = false;        ///< it restarted by itself
  std::uint8_t led_errors = 0;  ///< bits as kRedLed …
};

struct PatternStatus {
  bool ready = false;
  std::optional<int> shown;  ///< patterns of the current set; nullopt: it does not count them
};

/// One thread. Every call has a deadline. Errors: kProjector with what the controller refused.
class ProjectorController {
 public:
  virtual ~ProjectorController() = default;

  /// Waits until it has booted, then dark, under its ceiling and without a will of its own: as when it was opened. For
  /// a controller that has restarted by itself; arm() must follow.
  [[nodiscard]] virtual Result<void> prepare() = 0;
  /// Triggered from outside from now on. kBoardTiming: the controller cannot show this, and what it needs instead.
  [[nodiscard]] virtual Result<void> arm(const PatternTiming& timing) = 0;
  /// From pattern 0 on.
  [[nodiscard]] virtual Result<void> start() = 0;
  [[nodiscard]] virtual Result<void> stop() = 0;
  /// 0: dark. kConfigValue above the ceiling.
  [[nodiscard]] virtual Result<void> set_led(std::uint16_t code) = 0;
  /// All LEDs off; whatever fails, it was tried.
  virtual void blank() noexcept = 0;
  [[nodiscard]] virtual Result<ControllerStatus> status() = 0;
  [[nodiscard]] virtual Result<PatternStatus> pattern_status() = 0;
};

}  // namespace enamel::fw
