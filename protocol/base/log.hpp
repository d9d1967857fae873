// Log to stderr. stdout belongs to results. Safe from any thread.
#pragma once

#include <fmt/core.h>

#include <string_view>
#include <utility>

#include "protocol/base/result.hpp"

namespace enamel::log {

enum class Level : int { kTrace, kDebug, kInfo, kWarn, kError, kOff };

/// "trace" "debug" "info" "warn" "error" "off".
[[nodiscard]] Result<Level> parse_level(std::string_view name);

/// Initially the level named by the environment variable ENAMEL_LOG, else info.
void set_level(Level level);
[[nodiscard]] bool enabled(Level level);

/// One line: seconds since the program started (monotonic), level, thread, [module], text.
void write(Level level, std::string_view module, std::string_view text);

template <class... A>
void at(Level level, std::string_view module, fmt::format_string<A...> format, A&&... args) {
  if (enabled(level)) write(level, module, fmt::format(format, std::forward<A>(args)...));
}
/// The user must act.
template <class... A>
void error(std::string_view module, fmt::format_string<A...> format, A&&... args) {
  at(Level::kError, module, format, std::forward<A>(args)...);
}
/// Something is degraded.
template <class... A>
void warn(std::string_view module, fmt::format_string<A...> format, A&&... args) {
  at(Level::kWarn, module, format, std::forward<A>(args)...);
}
/// A change of state; at most about one a second.
template <class... A>
void info(std::string_view module, fmt::format_string<A...> format, A&&... args) {
  at(Level::kInfo, module, format, std::forward<A>(args)...);
}
template <class... A>
void debug(std::string_view module, fmt::format_string<A...> format, A&&... args) {
  at(Level::kDebug, module, format, std::forward<A>(args)...);
}

}  // namespace enamel::log
