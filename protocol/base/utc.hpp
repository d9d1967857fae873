// Wall time, for dates on files and reports. Nothing waits or stamps by it: see clock.hpp.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace enamel {

/// Seconds since 1970-01-01T00:00:00Z, by the machine's clock.
[[nodiscard]] std::int64_t utc_now_s();

/// "2026-01-31T12:00:00Z".
[[nodiscard]] std::string utc_text(std::int64_t seconds);

/// The inverse; empty when the text has another form.
[[nodiscard]] std::optional<std::int64_t> utc_seconds(const std::string& text);

}  // namespace enamel
