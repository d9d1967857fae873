#include <sodium/crypto_sign.h>

#include <cstring>

#include "protocol/image/ed25519.hpp"

namespace enamel::image {
namespace {

class Sodium final : public Ed25519 {
 public:
  bool verify(std::span<const std::byte> message, const SignatureBytes& signature,
              const PublicKey& key) const noexcept override {
    // libsodium wants the message in one piece; a manifest is at most this long.
    std::array<unsigned char, kSignatureDomain.size() + kMaxManifest> whole;
    if (message.size() > kMaxManifest) return false;
    std::memcpy(whole.data(), kSignatureDomain.data(), kSignatureDomain.size());
    std::memcpy(whole.data() + kSignatureDomain.size(), message.data(), message.size());
    return crypto_sign_verify_detached(signature.data(), whole.data(), kSignatureDomain.size() + message.size(),
                                       key.data()) == 0;
  }
};

}  // namespace

const Ed25519& sodium_ed25519() noexcept {
  static const Sodium instance;
  return instance;
}

}  // namespace enamel::image
