// What image and bootloader need of a cryptography library: one check.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "protocol/image/manifest.hpp"

namespace enamel::image {

using PublicKey = std::array<std::uint8_t, 32>;

/// What every signature is made over before the signed part: it is good for nothing but firmware.
inline constexpr std::array<std::uint8_t, 13> kSignatureDomain = {'e', 'n', 'a', 'm', 'e', 'l', '-',
                                                                  'f', 'w', '-', 'v', '1', '\0'};

/// Ed25519 (RFC 8032, not pre-hashed) of kSignatureDomain followed by a message.
class Ed25519 {
 public:
  virtual ~Ed25519() = default;
  [[nodiscard]] virtual bool verify(std::span<const std::byte> message, const SignatureBytes& signature,
                                    const PublicKey& key) const noexcept = 0;
};

/// By libsodium. The object has no state and lives as long as the program; thread-safe.
[[nodiscard]] const Ed25519& sodium_ed25519() noexcept;

}  // namespace enamel::image
