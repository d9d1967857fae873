// Messages of a DLPC350 in reports of 64 bytes:
//
//   u8 flags   bit 7 read, bit 6 a reply is wanted, bit 5 refused (NACK), bits 0-2 destination, 0
//   u8 sequence number, which the answer repeats
//   u16 bytes that follow, little endian
//   u8 CMD3, u8 CMD2, payload        of an answer: its data at once
//
// What does not fit goes on in further reports, which have no header. One answer, after the last.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "firmware/device/linux/dlpc350/commands.hpp"
#include "firmware/device/linux/dlpc350/hid_port.hpp"

namespace enamel::fw::dlpc350 {

enum class Direction : std::uint8_t { kWrite, kRead };

[[nodiscard]] std::vector<HidReport> reports_of(const Command& command, Direction direction, std::uint8_t sequence,
                                                std::span<const std::uint8_t> payload);

/// One command at a time, each with its answer within 0.5 s. Errors: kProjector, naming the command.
class Channel {
 public:
  explicit Channel(HidPort& port) : port_(&port) {}

  [[nodiscard]] Result<void> write(const Command& command, std::span<const std::uint8_t> payload);
  /// At least `size` bytes.
  [[nodiscard]] Result<std::vector<std::uint8_t>> read(const Command& command, std::size_t size);

 private:
  [[nodiscard]] Result<std::vector<std::uint8_t>> exchange(const Command& command, Direction direction,
                                                           std::span<const std::uint8_t> payload);
  [[nodiscard]] Result<void> forget_late_answers();
  [[nodiscard]] Result<std::vector<std::uint8_t>> answer(const Command& command);

  HidPort* port_;
  std::uint8_t sequence_ = 0;
};

}  // namespace enamel::fw::dlpc350
