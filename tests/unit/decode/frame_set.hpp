// Four frames, for tests.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/decode/phase/burst_view.hpp"

namespace enamel::test {

struct FrameSet {
  int width = 0, height = 0;
  std::array<std::vector<std::uint8_t>, 4> frames;
  int bit_depth = 8;

  [[nodiscard]] pipeline::BurstView view() const {
    pipeline::BurstView v{width, height, bit_depth, {}};
    for (std::size_t k = 0; k < 4; ++k) v.frames[k] = frames[k];
    return v;
  }
};

}  // namespace enamel::test
