// JSON as text, whatever bytes its strings hold. Thread-safe: no state.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace enamel {

/// `indent` < 0: on one line. Bytes that are no UTF-8, as in names of files written under another locale, become
/// U+FFFD: a report whose path reads oddly is better than none.
[[nodiscard]] inline std::string json_text(const nlohmann::json& json, int indent = -1) {
  return json.dump(indent, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace enamel
