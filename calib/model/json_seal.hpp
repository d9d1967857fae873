// Files that say whether they were changed: key sha256, taken over the file's own text with that key empty. Pure.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace enamel::calib {

/// The text of `json` with its seal, one level of indentation one blank wide, keys in their order.
[[nodiscard]] std::string sealed_text(nlohmann::ordered_json json);

/// Whether the seal, which has to be there, is that of the content. Anything that is no object has none.
[[nodiscard]] bool is_sealed(const nlohmann::ordered_json& json);

}  // namespace enamel::calib
