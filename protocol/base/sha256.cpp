#include "protocol/base/sha256.hpp"

#include <sodium/crypto_hash_sha256.h>

#include <cstring>

namespace enamel {
namespace {

using State = crypto_hash_sha256_state;
static_assert(std::is_trivially_copyable_v<State>);

template <std::size_t N>
State load(const std::array<std::byte, N>& bytes) noexcept {
  static_assert(sizeof(State) <= N);
  State s;
  std::memcpy(&s, bytes.data(), sizeof s);
  return s;
}

}  // namespace

std::string to_hex(std::span<const std::uint8_t> bytes) {
  static constexpr std::string_view kDigits = "0123456789abcdef";
  std::string out;
  out.reserve(bytes.size() * 2);
  for (const std::uint8_t b : bytes) {
    out += kDigits[b >> 4U];
    out += kDigits[b & 0xFU];
  }
  return out;
}

RollingHash::RollingHash() noexcept {
  State s;
  crypto_hash_sha256_init(&s);
  std::memcpy(state_.data(), &s, sizeof s);
}

RollingHash& RollingHash::update(std::span<const std::byte> bytes) noexcept {
  State s = load(state_);
  crypto_hash_sha256_update(&s, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  std::memcpy(state_.data(), &s, sizeof s);
  return *this;
}

Sha256Digest RollingHash::digest() const noexcept {
  State s = load(state_);
  Sha256Digest out{};
  crypto_hash_sha256_final(&s, out.data());
  return out;
}

std::string sha256_hex(std::span<const std::byte> bytes) { return to_hex(sha256(bytes)); }

}  // namespace enamel
