#include <sodium/crypto_sign.h>

#include <vector>

#include "protocol/image/builder.hpp"

namespace enamel::image {

static_assert(sizeof(SecretKey) == crypto_sign_SECRETKEYBYTES);

Signer make_signer(const SecretKey& secret) {
  Signer signer;
  crypto_sign_ed25519_sk_to_pk(signer.key.data(), secret.data());
  signer.sign = [secret](std::span<const std::byte> message) {
    std::vector<unsigned char> whole(kSignatureDomain.begin(), kSignatureDomain.end());
    const auto* first = reinterpret_cast<const unsigned char*>(message.data());
    whole.insert(whole.end(), first, first + message.size());
    SignatureBytes out{};
    crypto_sign_detached(out.data(), nullptr, whole.data(), whole.size(), secret.data());
    return out;
  };
  return signer;
}

}  // namespace enamel::image
