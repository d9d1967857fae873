// SHA-256 (FIPS 180-4) for a bootloader that has no libsodium: the same interface, no heap. Takes the place of
// protocol/base/sha256.cpp there; tests/arm64 holds the two against each other.
#include "protocol/base/sha256.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

namespace enamel {
namespace {

constexpr std::size_t kBlock = 64;

struct State {
  std::array<std::uint32_t, 8> h;
  std::uint64_t length;  ///< bytes so far
  std::array<std::uint8_t, kBlock> block;
};
static_assert(sizeof(State) <= 128 && std::is_trivially_copyable_v<State>);

constexpr std::array<std::uint32_t, 8> kInitial = {0x6A09E667, 0xBB67AE85, 0x3C6EF372, 0xA54FF53A,
                                                   0x510E527F, 0x9B05688C, 0x1F83D9AB, 0x5BE0CD19};

constexpr std::array<std::uint32_t, 64> kRound = {
    0x428A2F98, 0x71374491, 0xB5C0FBCF, 0xE9B5DBA5, 0x3956C25B, 0x59F111F1, 0x923F82A4, 0xAB1C5ED5,
    0xD807AA98, 0x12835B01, 0x243185BE, 0x550C7DC3, 0x72BE5D74, 0x80DEB1FE, 0x9BDC06A7, 0xC19BF174,
    0xE49B69C1, 0xEFBE4786, 0x0FC19DC6, 0x240CA1CC, 0x2DE92C6F, 0x4A7484AA, 0x5CB0A9DC, 0x76F988DA,
    0x983E5152, 0xA831C66D, 0xB00327C8, 0xBF597FC7, 0xC6E00BF3, 0xD5A79147, 0x06CA6351, 0x14292967,
    0x27B70A85, 0x2E1B2138, 0x4D2C6DFC, 0x53380D13, 0x650A7354, 0x766A0ABB, 0x81C2C92E, 0x92722C85,
    0xA2BFE8A1, 0xA81A664B, 0xC24B8B70, 0xC76C51A3, 0xD192E819, 0xD6990624, 0xF40E3585, 0x106AA070,
    0x19A4C116, 0x1E376C08, 0x2748774C, 0x34B0BCB5, 0x391C0CB3, 0x4ED8AA4A, 0x5B9CCA4F, 0x682E6FF3,
    0x748F82EE, 0x78A5636F, 0x84C87814, 0x8CC70208, 0x90BEFFFA, 0xA4506CEB, 0xBEF9A3F7, 0xC67178F2};

void put_big_endian(std::uint8_t* out, std::uint64_t value, std::size_t bytes) noexcept {
  for (std::size_t i = 0; i < bytes; ++i) out[i] = static_cast<std::uint8_t>(value >> (8 * (bytes - 1 - i)));
}

std::uint32_t big_endian(const std::uint8_t* p) noexcept {
  return std::uint32_t{p[0]} << 24U | std::uint32_t{p[1]} << 16U | std::uint32_t{p[2]} << 8U | std::uint32_t{p[3]};
}

/// FIPS 180-4 §6.2.2.
void compress(std::array<std::uint32_t, 8>& h, const std::array<std::uint8_t, kBlock>& block) noexcept {
  std::array<std::uint32_t, 64> w;
  for (std::size_t t = 0; t < 16; ++t) w[t] = big_endian(block.data() + 4 * t);
  for (std::size_t t = 16; t < 64; ++t) {
    const std::uint32_t s0 = std::rotr(w[t - 15], 7) ^ std::rotr(w[t - 15], 18) ^ w[t - 15] >> 3U;
    const std::uint32_t s1 = std::rotr(w[t - 2], 17) ^ std::rotr(w[t - 2], 19) ^ w[t - 2] >> 10U;
    w[t] = w[t - 16] + s0 + w[t - 7] + s1;
  }
  std::array<std::uint32_t, 8> v = h;
  for (std::size_t t = 0; t < 64; ++t) {
    const auto [a, b, c, d, e, f, g, last] = v;
    const std::uint32_t t1 =
        last + (std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25)) + ((e & f) ^ (~e & g)) + kRound[t] + w[t];
    const std::uint32_t t2 = (std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22)) + ((a & b) ^ (a & c) ^ (b & c));
    v = {t1 + t2, a, b, c, d + t1, e, f, g};
  }
  for (std::size_t i = 0; i < h.size(); ++i) h[i] += v[i];
}

void absorb(State& s, const std::uint8_t* bytes, std::size_t n) noexcept {
  while (n > 0) {
    const std::size_t at = s.length % kBlock, part = std::min(n, kBlock - at);
    std::memcpy(s.block.data() + at, bytes, part);
    s.length += part;
    bytes += part;
    n -= part;
    if (s.length % kBlock == 0) compress(s.h, s.block);
  }
}

State load(const std::array<std::byte, 128>& bytes) noexcept {
  State s;
  std::memcpy(&s, bytes.data(), sizeof s);
  return s;
}

}  // namespace

RollingHash::RollingHash() noexcept {
  const State s{kInitial, 0, {}};
  std::memcpy(state_.data(), &s, sizeof s);
}

RollingHash& RollingHash::update(std::span<const std::byte> bytes) noexcept {
  State s = load(state_);
  absorb(s, reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  std::memcpy(state_.data(), &s, sizeof s);
  return *this;
}

Sha256Digest RollingHash::digest() const noexcept {
  State s = load(state_);
  const std::uint64_t bits = 8 * s.length;
  // A one bit, zeros up to eight bytes before the end of a block, the length in bits.
  std::array<std::uint8_t, kBlock + 8> pad{0x80};
  const std::size_t zeros = (2 * kBlock - 1 - 8 - s.length % kBlock) % kBlock;
  put_big_endian(pad.data() + 1 + zeros, bits, 8);
  absorb(s, pad.data(), 1 + zeros + 8);
  Sha256Digest out{};
  for (std::size_t i = 0; i < s.h.size(); ++i) put_big_endian(out.data() + 4 * i, s.h[i], 4);
  return out;
}

}  // namespace enamel
