#include "host/motion/grbl_reply.hpp"

#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include "protocol/base/plain_text.hpp"

namespace enamel::motion {
namespace {

constexpr std::array<std::pair<std::string_view, GrblState>, 9> kStates{{{"Idle", GrblState::kIdle},
                                                                         {"Run", GrblState::kRun},
                                                                         {"Hold", GrblState::kHold},
                                                                         {"Jog", GrblState::kJog},
                                                                         {"Alarm", GrblState::kAlarm},
                                                                         {"Door", GrblState::kDoor},
                                                                         {"Check", GrblState::kCheck},
                                                                         {"Home", GrblState::kHome},
                                                                         {"Sleep", GrblState::kSleep}}};

std::optional<int> whole_number(std::string_view text) {
  int value = 0;
  const auto [end, ec] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (ec != std::errc{} || end != text.data() + text.size() || value < 0) return std::nullopt;
  return value;
}

std::optional<double> finite_number(std::string_view text) {
  double value = 0.0;
  const auto [end, ec] = std::from_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed);
  if (ec != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

bool read_state(std::string_view field, GrblStatus& status) {
  std::string_view rest = field;
  const std::string_view name = cut(rest, ':');
  for (const auto& [known, state] : kStates) {
    if (name != known) continue;
    status.state = state;
    if (name.size() == field.size()) return true;
    const auto sub = whole_number(rest);
    status.sub = sub.value_or(-1);
    return sub.has_value();
  }
  return false;
}

bool read_mpos(std::string_view list, GrblStatus& status) {
  for (double& value : status.mpos) {
    const auto number = finite_number(cut(list, ','));
    if (!number) return false;
    value = *number;
  }
  status.has_mpos = true;
  return true;
}

std::optional<GrblStatus> read_status(std::string_view line) {
  if (line.size() < 3 || line.front() != '<' || line.back() != '>') return std::nullopt;
  std::string_view rest = line.substr(1, line.size() - 2);
  GrblStatus status;
  if (!read_state(cut(rest, '|'), status)) return std::nullopt;
  constexpr std::string_view kMpos = "MPos:";
  while (!rest.empty()) {
    const std::string_view field = cut(rest, '|');
    if (field.starts_with(kMpos) && !read_mpos(field.substr(kMpos.size()), status)) return std::nullopt;
  }
  return status;
}

std::optional<GrblSetting> read_setting(std::string_view line) {
  std::string_view rest = line.substr(1);
  const auto number = whole_number(cut(rest, '='));
  // Settings of version 0.9 carry their meaning in brackets behind the value.
  const auto value = finite_number(rest.substr(0, rest.find(' ')));
  if (!number || !value) return std::nullopt;
  return GrblSetting{*number, *value};
}

std::string printable(std::string_view text) {
  constexpr std::size_t kMost = 40;
  std::string out;
  for (const char c : text.substr(0, kMost)) out += c >= ' ' && c <= '~' ? c : '?';
  return out;
}

/// Wherever it stands in the line: that the controller started is not to be missed for noise before it.
std::optional<GrblBanner> read_banner(std::string_view line) {
  constexpr std::string_view kName = "Grbl ";
  const std::size_t at = line.find(kName);
  if (at == std::string_view::npos || line.front() == '[') return std::nullopt;
  std::string_view rest = line.substr(at + kName.size());
  return GrblBanner{printable(cut(rest, ' '))};
}

}  // namespace

GrblReply parse_reply(std::string_view line) {
  constexpr std::string_view kError = "error:";
  constexpr std::string_view kAlarm = "ALARM:";
  if (line == "ok") return GrblOk{};
  if (line.starts_with(kError)) {
    if (const auto n = whole_number(line.substr(kError.size()))) return GrblError{*n};
  } else if (line.starts_with(kAlarm)) {
    if (const auto n = whole_number(line.substr(kAlarm.size()))) return GrblAlarm{*n};
  } else if (line.starts_with('<')) {
    if (const auto status = read_status(line)) return *status;
  } else if (line.starts_with('$')) {
    if (const auto setting = read_setting(line)) return *setting;
  } else if (line.starts_with('[') && line.ends_with(']')) {
    return GrblNote{printable(line)};
  } else if (const auto banner = line.empty() ? std::nullopt : read_banner(line)) {
    return *banner;
  }
  return GrblGarbled{printable(line)};
}

const char* grbl_state_name(GrblState state) noexcept {
  for (const auto& [name, known] : kStates)
    if (known == state) return name.data();
  return "?";
}

}  // namespace enamel::motion
