// Whether an image may run on a device: hardware, keys, signatures, age. Pure functions in the order of
// docs/firmware-image.md §1; used by the updater before the first erase, by the bootloader and by the flashing tool.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "protocol/image/ed25519.hpp"
#include "protocol/image/manifest.hpp"

namespace enamel::image {

/// A key compiled into the device. Its place in the list is its bit in the boot control block's `revoked`.
struct TrustedKey {
  PublicKey key{};
  bool development = false;  ///< good only on a device whose development fuse is set, for images that say so
};

struct Trust {
  std::span<const TrustedKey> keys;
  std::uint32_t revoked = 0;  ///< bit per key
  bool development_fuse = false;
  const Ed25519* ed25519 = nullptr;  ///< never null when used
  bool in_factory = false;           ///< the unit has not been delivered: images for the factory only are welcome
};

struct Hardware {
  std::uint32_t product_id = kProductId;
  std::uint16_t hw_rev = 0;
  ImageVersion bootloader;
  std::uint16_t protocol_version = 0;
};

/// What the device has now, against which an image's age is held.
struct Installed {
  std::uint32_t min_security_counter = 0;
  std::optional<ImageVersion> running;  ///< absent in recovery
  bool allow_older = false;             ///< a lower version is welcome; a lower counter never is
};

/// First 16 bytes of SHA-256(key).
[[nodiscard]] KeyId key_id(const PublicKey& key) noexcept;

/// kProduct, kHardware.
[[nodiscard]] Checked<void> check_hardware(const Manifest& manifest, const Hardware& hardware) noexcept;
/// kUnknownKey, kKeyRevoked, kDevSigned, kSignature. Every signature present must be by a good key and verify.
[[nodiscard]] Checked<void> check_signatures(const Manifest& manifest, const Trust& trust) noexcept;
/// kFactoryOnly. Not asked at boot: what was installed in the factory must not stop to boot in the field.
[[nodiscard]] Checked<void> check_place(const Manifest& manifest, const Trust& trust) noexcept;
/// kRollback.
[[nodiscard]] Checked<void> check_age(const Manifest& manifest, const Installed& installed) noexcept;

/// All four. A manifest for which this gives a value may be written to a slot.
[[nodiscard]] Checked<void> check_manifest(const Manifest& manifest, const Hardware& hardware, const Trust& trust,
                                           const Installed& installed) noexcept;

}  // namespace enamel::image
