// The probe's states as a table. Pure: no clock, no hardware.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "protocol/types/device.hpp"

namespace enamel::fw {

enum class Input : std::uint8_t {
  kBooted,
  kSelfTestOk,
  kCmdWarmup,
  kWarm,         ///< tip warm, stamp delay measured, projector ready
  kCmdStart,     ///< SCAN_START, SINGLE_BURST
  kPause,        ///< SCAN_PAUSE, drained
  kLeaseLost,    ///< drained
  kStop,         ///< SCAN_STOP or number of bursts reached, drained
  kSourceEnded,  ///< a finite source has no further burst
  kCmdSelfTest,  ///< also the way out of SAFE
  kUpdate,       ///< the update process has begun to take an image
  kUpdateOver,   ///< it gave the image up, or has ended
  kFault,
  kRetry,      ///< out of FAULT, by itself
  kInterlock,  ///< LED stuck, over-temperature …
  kSafeOff,    ///< command, from anyone
};
inline constexpr int kInputs = static_cast<int>(Input::kSafeOff) + 1;

struct Transition {
  proto::ProbeState from;
  Input input;
  proto::ProbeState to;
};

[[nodiscard]] std::span<const Transition> transitions() noexcept;
/// Nullopt: the input is not acceptable in this state.
[[nodiscard]] std::optional<proto::ProbeState> next_state(proto::ProbeState state, Input input) noexcept;
/// In these states someone may switch the light on. In all others it is off.
[[nodiscard]] constexpr bool light_permitted(proto::ProbeState state) noexcept {
  return state == proto::ProbeState::kScanning || state == proto::ProbeState::kSelftest ||
         state == proto::ProbeState::kWarmup;
}
[[nodiscard]] std::string_view name_of(Input input) noexcept;

}  // namespace enamel::fw
