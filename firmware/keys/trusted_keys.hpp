// The public keys that were compiled in (CMake's ENAMEL_FIRMWARE_KEYS, docs/firmware-image.md §6).
#pragma once

#include <span>

#include "protocol/image/trust.hpp"

namespace enamel::fw {

/// 1 to 32 keys, each at the place of its bit in the boot control block's `revoked`. A build that was given none holds
/// one development key, which only a probe with its development fuse set believes.
[[nodiscard]] std::span<const image::TrustedKey> trusted_keys() noexcept;

}  // namespace enamel::fw
