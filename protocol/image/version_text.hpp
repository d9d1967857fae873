// Versions as people write them: "1.2.3+4", major.minor.revision+build.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "protocol/image/manifest.hpp"

namespace enamel::image {

/// The build may be left out; nothing for other texts and for numbers out of range.
[[nodiscard]] std::optional<ImageVersion> parse_version(std::string_view text);
[[nodiscard]] std::string to_text(const ImageVersion& version);

}  // namespace enamel::image
