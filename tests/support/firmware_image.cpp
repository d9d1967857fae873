#include "tests/support/firmware_image.hpp"

#include <sodium/crypto_sign.h>

#include <algorithm>
#include <stdexcept>

#include "protocol/base/rng.hpp"

namespace enamel::test {

image::Signer make_signer(std::uint8_t seed) {
  std::array<unsigned char, crypto_sign_SEEDBYTES> bytes{};
  bytes.fill(seed);
  image::PublicKey key{};
  image::SecretKey secret{};
  crypto_sign_seed_keypair(key.data(), secret.data(), bytes.data());
  return image::make_signer(secret);
}

std::vector<std::byte> random_payload(std::size_t size, std::uint64_t seed) {
  Rng rng(seed, 0, 0);
  std::vector<std::byte> out(size);
  for (std::byte& b : out) b = static_cast<std::byte>(rng.next_u32() & 0xFFU);
  return out;
}

image::ImageDescription plain_description() {
  image::ImageDescription d;
  d.hw_rev_min = 1;
  d.hw_rev_max = 3;
  d.version = {1, 2, 3, 4};
  d.security_counter = 5;
  d.protocol = image::ProtocolRange{1, 2};
  d.min_bootloader = image::ImageVersion{0, 9, 0, 0};
  d.notes = "test image";
  return d;
}

image::Hardware test_hardware() { return {image::kProductId, 2, {1, 0, 0, 0}, 1}; }

std::vector<std::byte> build(const image::ImageDescription& description, std::span<const std::byte> payload,
                             std::span<const image::Signer> signers) {
  Result<std::vector<std::byte>> image = image::build_image(description, payload, signers);
  if (!image) throw std::runtime_error(image.error().message());
  return std::move(*image);
}

KeyRing::KeyRing() : signers_{make_signer(1), make_signer(2), make_signer(3)} {
  for (const image::Signer& s : signers_) keys_.push_back({s.key, false});
  keys_.back().development = true;
}

}  // namespace enamel::test
