// Text of one JSON object that says every thing once.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string_view>

#include "protocol/base/result.hpp"

namespace enamel::calib {

/// Error: `code`, for what is no JSON, no object, or has a key twice in one object, of which a parser would keep the
/// last without a word.
[[nodiscard]] Result<nlohmann::json> parse_json_object(std::string_view text, ErrorCode code);

}  // namespace enamel::calib
