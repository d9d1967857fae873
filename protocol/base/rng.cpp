#include "protocol/base/rng.hpp"

#include <cmath>
#include <numbers>

namespace enamel {
namespace {

constexpr std::uint32_t low_word(std::uint64_t v) { return static_cast<std::uint32_t>(v); }
constexpr std::uint32_t high_word(std::uint64_t v) { return static_cast<std::uint32_t>(v >> 32U); }

// Finaliser of SplitMix64: spreads session and stage over the 64-bit key.
constexpr std::uint64_t mix(std::uint64_t z) {
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
  return z ^ (z >> 31U);
}

}  // namespace

Rng::Rng(std::uint64_t session, std::uint64_t burst, std::uint32_t stage) noexcept
    : counter_{0, 0, low_word(burst), high_word(burst)} {
  const std::uint64_t key = mix(mix(session + 0x9E3779B97F4A7C15U) + stage);
  key_ = {low_word(key), high_word(key)};
}

std::uint32_t Rng::next_u32() noexcept {
  if (used_ == 4) {
    words_ = philox4x32(counter_, key_);
    used_ = 0;
    if (++counter_[0] == 0) ++counter_[1];
  }
  return words_[used_++];
}

std::uint64_t Rng::next_u64() noexcept {
  const std::uint64_t high = next_u32();
  return high << 32U | next_u32();
}

double Rng::uniform() noexcept { return static_cast<double>(next_u64() >> 11U) * 0x1p-53; }

std::uint32_t Rng::below(std::uint32_t n) noexcept {
  std::uint64_t product = std::uint64_t{next_u32()} * n;
  if (low_word(product) < n) {
    const std::uint32_t threshold = (0U - n) % n;
    while (low_word(product) < threshold) product = std::uint64_t{next_u32()} * n;
  }
  return high_word(product);
}

double Rng::normal() noexcept {
  if (has_spare_) {
    has_spare_ = false;
    return spare_normal_;
  }
  const double u = 1.0 - uniform();  // in (0, 1]: the logarithm is finite
  const double angle = 2.0 * std::numbers::pi * uniform();
  const double radius = std::sqrt(-2.0 * std::log(u));
  spare_normal_ = radius * std::sin(angle);
  has_spare_ = true;
  return radius * std::cos(angle);
}

}  // namespace enamel
