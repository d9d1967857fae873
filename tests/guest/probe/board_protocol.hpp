// Between the SIMULATED board and the shim that stands in for its device nodes: one message a packet on a local socket.
#pragma once

#include <array>
#include <cstdint>

namespace enamel::guest {

inline constexpr const char* kBoardSocket = "/run/board.sock";

/// What a connection is for; its first packet.
enum class Channel : std::uint8_t { kBus, kOutput, kEvents };
struct Hello {
  Channel channel = Channel::kBus;
  std::uint32_t line = 0;  ///< of kOutput
};

/// kBus: a write, or a read of `length` bytes, which is answered with one. kOutput: data[0] is the level, answered when
/// it has been set. kEvents: gpio_v2_line_event, one a packet, from the board.
struct Packet {
  std::uint8_t is_read = 0;
  std::uint8_t refused = 0;
  std::uint16_t length = 0;
  std::array<std::uint8_t, 1200> data{};
};

}  // namespace enamel::guest
