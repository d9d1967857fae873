// One line of a GRBL 1.1 controller, read strictly. Pure and thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

namespace enamel::motion {

enum class GrblState : std::uint8_t { kIdle, kRun, kHold, kJog, kAlarm, kDoor, kCheck, kHome, kSleep };

struct GrblOk {};
struct GrblError {
  int number = 0;
};
struct GrblAlarm {
  int number = 0;
};
/// <Idle|MPos:1.000,2.000,0.000|FS:0,0>
struct GrblStatus {
  GrblState state = GrblState::kAlarm;
  int sub = -1;  ///< Hold:0 stands, Hold:1 still slows down; -1: none
  bool has_mpos = false;
  std::array<double, 3> mpos{};  ///< machine position of X, Y, Z in the controller's units
};
/// $100=800.000
struct GrblSetting {
  int number = 0;
  double value = 0.0;
};
/// Grbl 1.1h ['$' for help]: the controller started, so whatever it was doing has ended.
struct GrblBanner {
  std::string version;  ///< "1.1h"
};
/// [MSG:…] and other lines in brackets
struct GrblNote {
  std::string text;
};
struct GrblGarbled {
  std::string text;  ///< printable, at most 40 characters
};

using GrblReply =
    std::variant<GrblOk, GrblError, GrblAlarm, GrblStatus, GrblSetting, GrblBanner, GrblNote, GrblGarbled>;

/// Never fails: what it does not know is GrblGarbled.
[[nodiscard]] GrblReply parse_reply(std::string_view line);

[[nodiscard]] const char* grbl_state_name(GrblState state) noexcept;

}  // namespace enamel::motion
