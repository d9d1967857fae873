// Puts a firmware image together (docs/firmware-image.md §1). For the signing tool and for tests; a device never
// builds.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/base/result.hpp"
#include "protocol/image/ed25519.hpp"
#include "protocol/image/manifest.hpp"

namespace enamel::image {

struct ImageDescription {
  std::uint32_t product_id = kProductId;
  std::uint16_t hw_rev_min = 0;
  std::uint16_t hw_rev_max = 0;
  ImageVersion version;
  std::uint32_t security_counter = 0;
  std::uint32_t flags = image_flags::kFull;
  std::uint64_t build_time_unix_s = 0;
  std::vector<Component> components;  ///< their digests are computed from the payload
  std::optional<ImageVersion> min_bootloader;
  std::optional<ProtocolRange> protocol;
  std::vector<std::byte> git_commit;  ///< 20 bytes or none
  std::string notes;
};

/// Signs kSignatureDomain followed by a message. The secret stays behind the function.
struct Signer {
  PublicKey key{};
  std::function<SignatureBytes(std::span<const std::byte> message)> sign;
};

/// Ed25519 secret as libsodium keeps it: seed, then public key.
using SecretKey = std::array<std::uint8_t, 64>;
/// Signs by libsodium; keeps a copy of the secret.
[[nodiscard]] Signer make_signer(const SecretKey& secret);

/// The whole file, with DFU suffix. No signers make an unsigned image, which every device refuses. kUsage names what of
/// the description cannot be: an empty or too long payload, a component outside it, more than two signers.
[[nodiscard]] Result<std::vector<std::byte>> build_image(const ImageDescription& description,
                                                         std::span<const std::byte> payload,
                                                         std::span<const Signer> signers);

}  // namespace enamel::image
