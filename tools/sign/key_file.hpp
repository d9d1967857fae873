// Key files of the signing tool: JSON, the secret one readable by its owner only.
#pragma once

#include <string>

#include "protocol/base/result.hpp"
#include "protocol/image/builder.hpp"
#include "protocol/image/trust.hpp"

namespace enamel::sign {

struct KeyPair {
  image::Signer signer;
  bool development = false;
};

/// Makes a pair: `path` (mode 0600) and `path`.pub. kFileWrite when either exists: keys are never overwritten.
[[nodiscard]] Result<image::TrustedKey> make_key(const std::string& path, bool development);
/// kFileNotFound, kFileRead; kConfigValue for a file that is no secret key or that others may read.
[[nodiscard]] Result<KeyPair> read_secret_key(const std::string& path);
/// From a public or a secret key file.
[[nodiscard]] Result<image::TrustedKey> read_public_key(const std::string& path);

}  // namespace enamel::sign
