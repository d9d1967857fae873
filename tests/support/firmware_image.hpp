// Signed firmware images for tests: keys from a seed, payload from a seed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/image/builder.hpp"
#include "protocol/image/trust.hpp"

namespace enamel::test {

/// A key pair that a number stands for.
[[nodiscard]] image::Signer make_signer(std::uint8_t seed);

[[nodiscard]] std::vector<std::byte> random_payload(std::size_t size, std::uint64_t seed);

/// An image description that `test_hardware` accepts: version 1.2.3+4, counter 5.
[[nodiscard]] image::ImageDescription plain_description();
[[nodiscard]] image::Hardware test_hardware();

/// build_image that must succeed.
[[nodiscard]] std::vector<std::byte> build(const image::ImageDescription& description,
                                           std::span<const std::byte> payload, std::span<const image::Signer> signers);

/// A device's keys: 0 production, 1 next production, 2 development.
class KeyRing {
 public:
  KeyRing();
  [[nodiscard]] const image::Signer& signer(std::size_t i) const { return signers_[i]; }
  [[nodiscard]] image::Trust trust() const { return {keys_, 0, false, &image::sodium_ed25519()}; }

 private:
  std::vector<image::Signer> signers_;
  std::vector<image::TrustedKey> keys_;
};

}  // namespace enamel::test
