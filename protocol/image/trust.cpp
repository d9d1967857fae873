#include "protocol/image/trust.hpp"

#include <algorithm>

namespace enamel::image {
namespace {

Checked<void> check_signature(const Manifest& manifest, std::size_t i, const Trust& trust) noexcept {
  const KeyId signer = manifest.signer(i);
  const auto key =
      std::find_if(trust.keys.begin(), trust.keys.end(), [&](const TrustedKey& k) { return key_id(k.key) == signer; });
  if (key == trust.keys.end()) return refuse(Refusal::kUnknownKey);
  const auto place = static_cast<std::uint32_t>(key - trust.keys.begin());
  if (place >= 32 || ((trust.revoked >> place) & 1U) != 0) return refuse(Refusal::kKeyRevoked);
  const bool says_development = (manifest.flags & image_flags::kDevelopment) != 0;
  if ((key->development || says_development) && !trust.development_fuse) return refuse(Refusal::kDevSigned);
  // A development key signs nothing that could pass for a release.
  if (key->development && !says_development) return refuse(Refusal::kDevSigned);
  if (!trust.ed25519->verify(manifest.signed_part, manifest.signature(i), key->key)) {
    return refuse(Refusal::kSignature);
  }
  return {};
}

}  // namespace

KeyId key_id(const PublicKey& key) noexcept {
  const Sha256Digest digest = sha256(std::as_bytes(std::span(key)));
  KeyId id{};
  std::copy_n(digest.begin(), id.size(), id.begin());
  return id;
}

Checked<void> check_hardware(const Manifest& manifest, const Hardware& hardware) noexcept {
  if (manifest.product_id != hardware.product_id) return refuse(Refusal::kProduct);
  if (hardware.hw_rev < manifest.hw_rev_min || hardware.hw_rev > manifest.hw_rev_max) {
    return refuse(Refusal::kHardware);
  }
  if (manifest.min_bootloader && hardware.bootloader < *manifest.min_bootloader) return refuse(Refusal::kHardware);
  if (manifest.protocol && (hardware.protocol_version < manifest.protocol->lowest ||
                            hardware.protocol_version > manifest.protocol->highest)) {
    return refuse(Refusal::kHardware);
  }
  return {};
}

Checked<void> check_signatures(const Manifest& manifest, const Trust& trust) noexcept {
  if (manifest.signature_count == 0) return refuse(Refusal::kUnsigned);
  for (std::size_t i = 0; i < manifest.signature_count; ++i) ENAMEL_CHECK_THAT(check_signature(manifest, i, trust));
  return {};
}

Checked<void> check_place(const Manifest& manifest, const Trust& trust) noexcept {
  const bool factory_only = (manifest.flags & image_flags::kFactoryOnly) != 0;
  if (factory_only && !trust.in_factory) return refuse(Refusal::kFactoryOnly);
  return {};
}

Checked<void> check_age(const Manifest& manifest, const Installed& installed) noexcept {
  if (manifest.security_counter < installed.min_security_counter) return refuse(Refusal::kRollback);
  if (installed.running && !installed.allow_older && manifest.version < *installed.running) {
    return refuse(Refusal::kRollback);
  }
  return {};
}

Checked<void> check_manifest(const Manifest& manifest, const Hardware& hardware, const Trust& trust,
                             const Installed& installed) noexcept {
  ENAMEL_CHECK_THAT(check_hardware(manifest, hardware));
  ENAMEL_CHECK_THAT(check_signatures(manifest, trust));
  ENAMEL_CHECK_THAT(check_place(manifest, trust));
  return check_age(manifest, installed);
}

}  // namespace enamel::image
