// JSON as text, whatever bytes its strings hold. Thread-safe: no state.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace enamel {

/// `json`: nlohmann's, ordered or not. `indent` < 0: on one line. Bytes that are no UTF-8, as in names of files written
/// under another locale, become U+FFFD: a report whose path reads oddly is better than none.
template <class Json>
[[nodiscard]] std::string json_text(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace enamel
