// Time of day, for logs that people compare with other logs. Never for measuring: it may jump.
#pragma once

#include <chrono>
#include <string>

namespace enamel {

using WallTime = std::chrono::system_clock::time_point;

[[nodiscard]] WallTime wall_time();

/// UTC as "2026-01-31T23:59:59.123Z": texts sort as the times do.
[[nodiscard]] std::string to_utc_text(WallTime time);

}  // namespace enamel
