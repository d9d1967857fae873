// What was signed with a key: one JSON line each, beside the key. A signature is given only to what is newer.
#pragma once

#include <optional>
#include <string>

#include "protocol/base/result.hpp"
#include "protocol/image/manifest.hpp"

namespace enamel::sign {

struct SignedVersion {
  image::ImageVersion version;
  std::uint32_t security_counter = 0;
};

/// The newest entry of a log; nothing when the file does not exist. kConfigSyntax names a line that is not readable.
[[nodiscard]] Result<std::optional<SignedVersion>> newest_in_log(const std::string& path);
/// Appends an entry.
[[nodiscard]] Result<void> append_to_log(const std::string& path, const SignedVersion& entry,
                                         const std::string& image_sha256);

/// kUsage when `next` is not newer than `before`, or its counter lower.
[[nodiscard]] Result<void> check_newer(const SignedVersion& next, const std::optional<SignedVersion>& before,
                                       const std::string& where);

}  // namespace enamel::sign
