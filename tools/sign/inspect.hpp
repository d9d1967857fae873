// What an image is, for people and machines.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "protocol/image/manifest.hpp"

namespace enamel::sign {

[[nodiscard]] nlohmann::json describe(const image::Manifest& manifest);

}  // namespace enamel::sign
