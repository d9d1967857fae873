// Time of day, for dates on files, reports and logs. Never for measuring: it may jump; see clock.hpp.
#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace enamel {

using WallTime = std::chrono::system_clock::time_point;

[[nodiscard]] WallTime wall_time();

/// "2026-01-31T12:00:00Z".
[[nodiscard]] std::string utc_text(WallTime time);

/// "2026-01-31T12:00:00.123Z": texts sort as the times do.
[[nodiscard]] std::string utc_text_ms(WallTime time);

/// The inverse of utc_text; empty when the text has another form.
[[nodiscard]] std::optional<WallTime> parse_utc(const std::string& text);

}  // namespace enamel
