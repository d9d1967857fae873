// How far apart the points of neighbouring pixels lie: the length that "next to each other" is measured by.
#pragma once

#include <cstddef>

#include "pipeline/types/geometry.hpp"
#include "pipeline/types/map.hpp"

namespace enamel::pipeline {

/// Mean distance of neighbours in a row, over every eighth row; gaps of 0.5 mm and more apart. 0 when there are none.
[[nodiscard]] inline double mean_pitch_mm(const Map<Vec3f>& points) {
  double sum = 0;
  std::size_t count = 0;
  for (int v = 0; v < points.height(); v += 8) {
    for (int u = 1; u < points.width(); ++u) {
      const float d = (points(u, v) - points(u - 1, v)).norm();
      if (!(d < 0.5F)) continue;
      sum += static_cast<double>(d);
      ++count;
    }
  }
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

}  // namespace enamel::pipeline
