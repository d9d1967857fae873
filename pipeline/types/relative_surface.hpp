// Surface whose fringe order one burst leaves open: its phase is known up to whole turns. The model may tell them
// (model/guide).
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

namespace enamel {

inline constexpr std::int32_t kOpenOrder = std::numeric_limits<std::int32_t>::min();

struct RelativeSurface {
  /// Pixels begin … end-1 of one row, all of one region: Phi = phase + 2 pi (wraps + k), one k for the whole region.
  struct Span {
    std::int32_t row = 0, begin = 0, end = 0;
    std::int32_t region = 0, wraps = 0;
  };
  /// Orders k that the depth range leaves open to at least one of its pixels: low … high.
  struct Region {
    std::int32_t low = 0, high = -1;
    std::int32_t pixels = 0;
  };
  std::vector<Span> spans;  ///< in row order
  std::vector<Region> regions;
  std::vector<float> phase_rad, sigma_rad;  ///< of the spans' pixels, one after the other

  void clear() noexcept {
    spans.clear();
    regions.clear();
    phase_rad.clear();
    sigma_rad.clear();
  }
};

}  // namespace enamel
