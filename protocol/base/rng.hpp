// Counter-based random numbers: draw n of a stream depends on (key, n) only, so any thread may compute any part of it.
#pragma once

#include <array>
#include <cstdint>

namespace enamel {

/// Philox4x32-10 (Salmon et al., "Parallel random numbers: as easy as 1, 2, 3", SC 2011): four words from counter and
/// key.
[[nodiscard]] constexpr std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> ctr,
                                                                std::array<std::uint32_t, 2> key) noexcept {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t p0 = std::uint64_t{0xD2511F53U} * ctr[0];
    const std::uint64_t p1 = std::uint64_t{0xCD9E8D57U} * ctr[2];
    ctr = {static_cast<std::uint32_t>(p1 >> 32U) ^ ctr[1] ^ key[0], static_cast<std::uint32_t>(p1),
           static_cast<std::uint32_t>(p0 >> 32U) ^ ctr[3] ^ key[1], static_cast<std::uint32_t>(p0)};
    key[0] += 0x9E3779B9U;
    key[1] += 0xBB67AE85U;
  }
  return ctr;
}

/// One stream per (session or seed, burst, stage). Own conversions: std::*_distribution differs between libraries.
/// Not thread-safe; make one per unit of work.
class Rng {
 public:
  Rng(std::uint64_t session, std::uint64_t burst, std::uint32_t stage) noexcept;

  [[nodiscard]] std::uint32_t next_u32() noexcept;
  [[nodiscard]] std::uint64_t next_u64() noexcept;
  /// In [0, 1), 53 bits.
  [[nodiscard]] double uniform() noexcept;
  [[nodiscard]] double uniform(double low, double high) noexcept { return low + (high - low) * uniform(); }
  /// In [0, n), without bias (Lemire 2019); n > 0.
  [[nodiscard]] std::uint32_t below(std::uint32_t n) noexcept;
  /// Mean 0, variance 1 (Box and Muller 1958).
  [[nodiscard]] double normal() noexcept;

 private:
  std::array<std::uint32_t, 4> counter_;
  std::array<std::uint32_t, 2> key_;
  std::array<std::uint32_t, 4> words_{};
  std::uint32_t used_ = 4;
  double spare_normal_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace enamel
