// Four frames as they lie in memory; owns nothing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace enamel::pipeline {

/// Rows top-down without padding. bit_depth 8: one byte a pixel; 9…16: two, little endian.
struct BurstView {
  int width = 0;
  int height = 0;
  int bit_depth = 8;
  std::array<std::span<const std::uint8_t>, 4> frames{};

  [[nodiscard]] bool is_consistent() const noexcept {
    if (width <= 0 || height <= 0 || bit_depth < 8 || bit_depth > 16) return false;
    const std::size_t bytes =
        static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * (bit_depth > 8 ? 2 : 1);
    for (const auto& f : frames)
      if (f.size() != bytes) return false;
    return true;
  }
};

}  // namespace enamel::pipeline
