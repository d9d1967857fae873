// Runs of equal bytes in a row of marks, eight at a time.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace enamel::pipeline {

static_assert(std::endian::native == std::endian::little, "the first byte in memory is a word's lowest");

inline constexpr std::size_t kRunPadding = 8;  ///< layout: readable bytes behind a row; the first must end every run

/// Index of the first byte from `from` on that is not `value`.
[[nodiscard]] inline std::size_t end_of_run(const std::uint8_t* bytes, std::size_t from, std::uint8_t value) noexcept {
  const std::uint64_t same = 0x0101010101010101U * value;
  for (std::size_t i = from;; i += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes + i, 8);
    if (word != same) return i + static_cast<std::size_t>(std::countr_zero(word ^ same)) / 8;
  }
}

}  // namespace enamel::pipeline
