// For loops that a compiler is to work many elements at a time of: see simd.hpp.
#pragma once

#include <bit>
#include <cstdint>

/// Before a loop: its iterations touch different elements, whatever the pointers' names suggest.
#if defined(__clang__)
#define ENAMEL_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#else
#define ENAMEL_INDEPENDENT _Pragma("GCC ivdep")
#endif

namespace enamel::pipeline {

/// c ? a : b without a branch that a compiler could thread through a loop: loops of selects vectorise everywhere.
[[nodiscard]] inline float select(bool c, float a, float b) noexcept {
  const std::uint32_t mask = 0U - static_cast<std::uint32_t>(c);
  return std::bit_cast<float>((std::bit_cast<std::uint32_t>(a) & mask) | (std::bit_cast<std::uint32_t>(b) & ~mask));
}

}  // namespace enamel::pipeline
