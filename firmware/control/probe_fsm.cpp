#include "firmware/control/probe_fsm.hpp"

#include <array>

namespace enamel::fw {
namespace {

using S = proto::ProbeState;
using I = Input;

constexpr std::array kTable{
    Transition{S::kBoot, I::kBooted, S::kSelftest},
    Transition{S::kSelftest, I::kSelfTestOk, S::kIdle},
    Transition{S::kIdle, I::kCmdWarmup, S::kWarmup},
    Transition{S::kIdle, I::kCmdSelfTest, S::kSelftest},
    Transition{S::kWarmup, I::kWarm, S::kReady},
    Transition{S::kWarmup, I::kStop, S::kIdle},
    Transition{S::kReady, I::kCmdStart, S::kScanning},
    Transition{S::kReady, I::kCmdWarmup, S::kWarmup},
    Transition{S::kReady, I::kCmdSelfTest, S::kSelftest},
    Transition{S::kScanning, I::kPause, S::kPaused},
    Transition{S::kScanning, I::kLeaseLost, S::kPaused},
    Transition{S::kScanning, I::kStop, S::kReady},
    Transition{S::kScanning, I::kSourceEnded, S::kIdle},
    Transition{S::kPaused, I::kCmdStart, S::kScanning},
    Transition{S::kPaused, I::kStop, S::kReady},
    Transition{S::kPaused, I::kCmdWarmup, S::kWarmup},
    Transition{S::kFault, I::kRetry, S::kSelftest},
    Transition{S::kFault, I::kCmdSelfTest, S::kSelftest},
    Transition{S::kSafe, I::kCmdSelfTest, S::kSelftest},
    Transition{S::kIdle, I::kUpdate, S::kUpdating},
    Transition{S::kReady, I::kUpdate, S::kUpdating},
    Transition{S::kUpdating, I::kUpdateOver, S::kIdle},
    // Trouble, from wherever the probe is. SAFE is latched: a fault does not leave it.
    Transition{S::kSelftest, I::kFault, S::kFault},
    Transition{S::kIdle, I::kFault, S::kFault},
    Transition{S::kWarmup, I::kFault, S::kFault},
    Transition{S::kReady, I::kFault, S::kFault},
    Transition{S::kScanning, I::kFault, S::kFault},
    Transition{S::kPaused, I::kFault, S::kFault},
    Transition{S::kBoot, I::kInterlock, S::kSafe},
    Transition{S::kSelftest, I::kInterlock, S::kSafe},
    Transition{S::kIdle, I::kInterlock, S::kSafe},
    Transition{S::kWarmup, I::kInterlock, S::kSafe},
    Transition{S::kReady, I::kInterlock, S::kSafe},
    Transition{S::kScanning, I::kInterlock, S::kSafe},
    Transition{S::kPaused, I::kInterlock, S::kSafe},
    Transition{S::kFault, I::kInterlock, S::kSafe},
    Transition{S::kUpdating, I::kInterlock, S::kSafe},
    Transition{S::kBoot, I::kSafeOff, S::kSafe},
    Transition{S::kSelftest, I::kSafeOff, S::kSafe},
    Transition{S::kIdle, I::kSafeOff, S::kSafe},
    Transition{S::kWarmup, I::kSafeOff, S::kSafe},
    Transition{S::kReady, I::kSafeOff, S::kSafe},
    Transition{S::kScanning, I::kSafeOff, S::kSafe},
    Transition{S::kPaused, I::kSafeOff, S::kSafe},
    Transition{S::kFault, I::kSafeOff, S::kSafe},
    Transition{S::kUpdating, I::kSafeOff, S::kSafe},
};

}  // namespace

std::span<const Transition> transitions() noexcept { return kTable; }

std::optional<proto::ProbeState> next_state(proto::ProbeState state, Input input) noexcept {
  for (const Transition& t : kTable) {
    if (t.from == state && t.input == input) return t.to;
  }
  return std::nullopt;
}

std::string_view name_of(Input input) noexcept {
  constexpr std::array<std::string_view, kInputs> kNames{
      "booted",       "self-test passed", "WARMUP", "warm",        "start", "pause", "lease lost", "stop",
      "source ended", "SELFTEST",         "update", "update over", "fault", "retry", "interlock",  "SAFE_OFF"};
  const auto i = static_cast<std::size_t>(input);
  return i < kNames.size() ? kNames[i] : "?";
}

}  // namespace enamel::fw
