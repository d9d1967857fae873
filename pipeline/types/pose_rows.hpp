// A rigid motion from the rows of its matrix, as plain files and models without Eigen have it.
#pragma once

#include <array>
#include <cstddef>

#include "pipeline/types/geometry.hpp"

namespace enamel {

/// The last row is taken to be 0 0 0 1.
[[nodiscard]] inline Pose pose_of_rows(const std::array<std::array<double, 4>, 4>& rows) {
  Pose T = Pose::Identity();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) T(r, c) = rows[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)];
  }
  return T;
}

}  // namespace enamel
