// Public keys from the files that enamel-sign makes.
#pragma once

#include <string>
#include <vector>

#include "protocol/base/result.hpp"
#include "protocol/image/trust.hpp"

namespace enamel::fw {

/// In the order of `paths`. kFileNotFound, kFileRead; kConfigValue for a file that is no public key.
[[nodiscard]] Result<std::vector<image::TrustedKey>> read_public_keys(const std::vector<std::string>& paths);

}  // namespace enamel::fw
