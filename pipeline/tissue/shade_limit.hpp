// Where teeth end and soft tissue begins, by all shades that a scan has shown: mucosa lets light in but drinks it, so
// that it lies more than an octave below enamel. Nobody tells beforehand how bright a probe's light is, or how white
// the teeth are: the limit is what parts the scan's own shades in two heaps, and there is none while they are one.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "pipeline/types/shade.hpp"

namespace enamel::pipeline {

struct ShadeHeaps {
  std::uint8_t soft_below = kNothingSoft;   ///< kNothingSoft: shades are one heap, or two too near
  double soft_middle = 0, hard_middle = 0;  ///< steps: means of the two heaps that part best
  double parted = 0;                        ///< share of the variance that lies between them, 0 … 1
};

class ShadeLimit {
 public:
  /// One more burst's. The order of bursts does not matter.
  void add(const ShadeMap& shade) noexcept;
  [[nodiscard]] ShadeHeaps heaps() const noexcept;
  [[nodiscard]] std::uint64_t cells() const noexcept { return cells_; }

 private:
  std::array<std::uint64_t, 256> counts_{};
  std::uint64_t cells_ = 0;
};

}  // namespace enamel::pipeline
