// Pixels of the SIMULATED camera's n-th frame: any byte lost, moved or altered on the way is seen.
#pragma once

#include <cstdint>
#include <span>

namespace enamel::guest {

/// The counter in the first four bytes, then noise that depends on it and on the place.
inline void fill_frame(std::uint32_t counter, std::span<std::uint8_t> pixels) {
  std::uint32_t state = counter * 2654435761U + 1U;
  for (std::uint8_t& p : pixels) {
    state = state * 1664525U + 1013904223U;
    p = static_cast<std::uint8_t>(state >> 24U);
  }
  for (std::size_t i = 0; i < 4 && i < pixels.size(); ++i) {
    pixels[i] = static_cast<std::uint8_t>(counter >> (8 * i));
  }
}

inline std::uint32_t counter_of(std::span<const std::uint8_t> pixels) {
  std::uint32_t counter = 0;
  for (std::size_t i = 0; i < 4; ++i) counter |= std::uint32_t{pixels[i]} << (8 * i);
  return counter;
}

}  // namespace enamel::guest
