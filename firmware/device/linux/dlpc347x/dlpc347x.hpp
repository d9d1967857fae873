// DLPC3470, 3478 and 3479 over I2C: internal patterns, triggered from outside. Opcodes and payloads: TI DLPU075,
// DLPU081.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "firmware/device/linux/dlpc347x/i2c_bus.hpp"
#include "firmware/device/linux/projector/controller.hpp"
#include "protocol/base/clock.hpp"

namespace enamel::fw {

inline constexpr std::uint8_t kDlpcAddress = 0x1B;  // seven bits

class Dlpc347x final : public ProjectorController {
 public:
  /// Waits for the controller to boot (at most 3 s), checks what it is, then sets what a measurement needs: LEDs by
  /// hand, under the ceiling, and everything off that makes brightness depend on content. The light stays off.
  [[nodiscard]] static Result<Dlpc347x> open(I2cBus& bus, Clock& clock, const ProjectorLimits& limits);

  /// Asks the controller whether it can show this. kBoardTiming with what it needs instead.
  [[nodiscard]] Result<void> validate(const PatternTiming& timing);
  /// Writes the block into flash and reads it back. Takes seconds.
  [[nodiscard]] Result<void> load(std::span<const std::uint8_t> block);
  /// Trigger settings, then the mode, in which alone they take effect, then waits until ready.
  [[nodiscard]] Result<void> prepare() override;
  [[nodiscard]] Result<void> arm(const PatternTiming& timing) override;
  [[nodiscard]] Result<void> start() override;
  [[nodiscard]] Result<void> stop() override;
  [[nodiscard]] Result<void> set_led(std::uint16_t code) override;
  void blank() noexcept override;
  [[nodiscard]] Result<ControllerStatus> status() override;
  [[nodiscard]] Result<PatternStatus> pattern_status() override;

 private:
  Dlpc347x(I2cBus& bus, Clock& clock, const ProjectorLimits& limits) : bus_(&bus), clock_(&clock), limits_(limits) {}
  [[nodiscard]] Result<void> write(std::uint8_t opcode, std::span<const std::uint8_t> payload);
  [[nodiscard]] Result<std::vector<std::uint8_t>> read(std::uint8_t opcode, std::span<const std::uint8_t> payload,
                                                       std::size_t size);
  [[nodiscard]] Result<void> wait_booted();
  [[nodiscard]] Result<void> limit_light();
  [[nodiscard]] Result<void> wait_erased();

  I2cBus* bus_;
  Clock* clock_;
  ProjectorLimits limits_;
};

}  // namespace enamel::fw
