// DLPC350 of a LightCrafter 4500, over USB: four 8-bit patterns out of its firmware's images, triggered from outside.
// For benches. Commands and payloads: TI DLPU010.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "firmware/device/linux/dlpc350/message.hpp"
#include "firmware/device/linux/projector/controller.hpp"
#include "protocol/base/clock.hpp"

namespace enamel::fw {

inline constexpr std::uint16_t kDlpc350MostLedCode = 255;
inline constexpr std::uint8_t kDlpc350LastImage = 62;  ///< that another one follows
/// The controller keeps no ceiling: it is held here, and every write is read back.
inline constexpr ProjectorLimits kDlpc350Limits{.max_led_code = 120, .leds = kBlueLed};
/// 120 Hz is its fastest with eight bits; black behind a pattern takes 230 us.
inline constexpr PatternTiming kDlpc350Timing{.illum_us = 8333, .pre_us = 100, .post_us = 230, .bits = 8};

/// What fails, each with both sides of its inequality; empty: the timing holds. Pure.
[[nodiscard]] std::vector<std::string> dlpc350_timing_faults(const PatternTiming& timing);

/// A call that fails takes the light off, as far as the controller still listens.
class Dlpc350 final : public ProjectorController {
 public:
  /// `image`: of the two flash images with the patterns, the first: 0, 1 and 2 in its green, red and blue, 3 in the
  /// green of the next. The light goes off first of all and stays off. kConfigValue for limits beyond its range.
  [[nodiscard]] static Result<Dlpc350> open(HidPort& port, Clock& clock, const ProjectorLimits& limits,
                                            std::uint8_t image);

  [[nodiscard]] Result<void> prepare() override;
  /// Display mode, then the table, which the controller then checks. kBoardTiming, kProjector with every fault.
  [[nodiscard]] Result<void> arm(const PatternTiming& timing) override;
  /// Not before arm().
  [[nodiscard]] Result<void> start() override;
  [[nodiscard]] Result<void> stop() override;
  [[nodiscard]] Result<void> set_led(std::uint16_t code) override;
  void blank() noexcept override;
  [[nodiscard]] Result<ControllerStatus> status() override;
  [[nodiscard]] Result<PatternStatus> pattern_status() override;

 private:
  Dlpc350(HidPort& port, Clock& clock, const ProjectorLimits& limits, std::uint8_t image)
      : channel_(port), clock_(&clock), limits_(limits), image_(image) {}
  [[nodiscard]] Result<void> go_dark();
  [[nodiscard]] Result<void> write_currents(std::uint16_t code);
  [[nodiscard]] Result<void> write_triggers(const PatternTiming& timing);
  [[nodiscard]] Result<void> write_table(const PatternTiming& timing);
  [[nodiscard]] Result<void> write_mailbox(std::uint8_t mailbox, std::span<const std::uint8_t> data);
  [[nodiscard]] Result<void> validate();
  [[nodiscard]] Result<void> run();
  [[nodiscard]] Result<void> light(std::uint16_t code);
  [[nodiscard]] Result<void> set_up(const PatternTiming& timing);
  [[nodiscard]] Result<void> or_dark(Result<void> done);
  [[nodiscard]] Result<std::uint8_t> byte(const dlpc350::Command& command);

  dlpc350::Channel channel_;
  Clock* clock_;
  ProjectorLimits limits_;
  std::uint8_t image_;
  bool is_valid_ = false;
};

}  // namespace enamel::fw
