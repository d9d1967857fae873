#include "host/motion/grbl_text.hpp"

#include <fmt/format.h>

#include <array>

namespace enamel::motion {
namespace {

constexpr std::array<GrblText, 9> kAlarms{{
    {1, "a limit switch was hit in a move, the position is lost",
     "clear what is in the way, check the switch's wiring against noise, home again"},
    {2, "the target lies outside the controller's soft limits",
     "correct $130, $131 or the profile's limits, home again"},
    {3, "reset in the middle of a move, the position is lost",
     "home again; check supply and cable if nobody pressed reset"},
    {4, "the probe input is not in its first state", "leave the probe input unconnected, home again"},
    {5, "the probe input did not answer", "leave the probe input unconnected, home again"},
    {6, "homing was interrupted by a reset", "home again"},
    {7, "the safety door opened while homing", "close it or set the door input aside, home again"},
    {8, "homing: the switch stays closed after pulling off", "raise $27, or check the switch's wiring"},
    {9, "homing: no switch found within the search distance",
     "check switch, motor supply and driver current; raise $130, $131; see $23 for the direction"},
}};

constexpr std::string_view kOurLine =
    "the line was damaged on its way or the firmware is not Grbl 1.1: check the cable";

constexpr std::array<GrblText, 35> kErrors{{
    {1, "a word has no letter", kOurLine},
    {2, "a number is missing or malformed", kOurLine},
    {3, "unknown $ command", kOurLine},
    {4, "a negative value where a positive one belongs", kOurLine},
    {5, "homing is switched off", "fit home switches and set $22=1"},
    {6, "the step pulse is shorter than 3 us", "set $0=10"},
    {7, "the settings' memory could not be read, defaults are in force", "write the $ settings again: docs/desktop.md"},
    {8, "only possible while idle", "wait for the table to stand, then home"},
    {9, "locked: alarm or jog", "home again; the lock guards an unknown position"},
    {10, "soft limits need homing", "set $22=1, then $20=1"},
    {11, "the line is too long", kOurLine},
    {12, "the setting asks for more than 30 kHz of steps", "lower $110, $111 or $100, $101"},
    {13, "the safety door is open", "close it or set the door input aside, home again"},
    {14, "a stored line is too long", "clear $N0 and $N1"},
    {15, "the jog target lies outside the travel", "correct $130, $131 or the profile's limits"},
    {16, "jog without target", kOurLine},
    {17, "laser mode needs PWM", "set $32=0"},
    {20, "unsupported command", kOurLine},
    {21, "two commands of one group", kOurLine},
    {22, "no feed rate", "give feed_deg_per_s in the profile"},
    {23, "a whole number was expected", kOurLine},
    {24, "two commands that want axes", kOurLine},
    {25, "a word stands twice", "give rotation and swing different axis letters"},
    {26, "no axis in a command that wants one", kOurLine},
    {27, "line number not usable", kOurLine},
    {28, "a word is missing", kOurLine},
    {29, "coordinate system not supported", kOurLine},
    {30, "G53 without G0 or G1", kOurLine},
    {31, "axis without a command that wants one", kOurLine},
    {32, "arc without axis", kOurLine},
    {33, "motion target not usable", kOurLine},
    {34, "arc radius not usable", kOurLine},
    {35, "arc without offset", kOurLine},
    {36, "words left over", kOurLine},
    {37, "tool offset on another axis", kOurLine},
}};

std::string text_of(std::string_view kind, int number, std::span<const GrblText> table) {
  for (const GrblText& t : table) {
    if (t.number == number) return fmt::format("{}:{}: {}: {}", kind, number, t.meaning, t.remedy);
  }
  return fmt::format("{}:{}: not one of Grbl 1.1: see the manual of the firmware, or flash Grbl 1.1", kind, number);
}

}  // namespace

std::span<const GrblText> grbl_alarms() noexcept { return kAlarms; }
std::span<const GrblText> grbl_errors() noexcept { return kErrors; }
std::string alarm_text(int number) { return text_of("ALARM", number, kAlarms); }
std::string error_text(int number) { return text_of("error", number, kErrors); }

}  // namespace enamel::motion
