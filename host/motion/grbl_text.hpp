// What the numbers of GRBL 1.1 mean to a person: ALARM:N and error:N with what to do. Thread-safe: static storage.
// Source: Grbl 1.1, doc/csv/alarm_codes_en_US.csv and error_codes_en_US.csv.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace enamel::motion {

struct GrblText {
  int number;
  std::string_view meaning;
  std::string_view remedy;
};

[[nodiscard]] std::span<const GrblText> grbl_alarms() noexcept;
[[nodiscard]] std::span<const GrblText> grbl_errors() noexcept;

/// "ALARM:1: a limit switch was hit …: turn …"; a number that is not in the table says so.
[[nodiscard]] std::string alarm_text(int number);
[[nodiscard]] std::string error_text(int number);

}  // namespace enamel::motion
