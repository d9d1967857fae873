// How finely a file's numbers can say where something lies.
#pragma once

#include <vector>

#include "pipeline/types/geometry.hpp"

namespace enamel::host {

/// The coarsest step, mm, of the coordinates along the axes on which `origin_mm` is not 0: of single precision there,
/// where the file keeps `floats` or its doubles are rounded floats, or of the decimals written. 0 when none is seen.
/// `positions` are finite and at least one.
[[nodiscard]] double number_step(const std::vector<Vec3d>& positions, const Vec3d& origin_mm, bool floats);

}  // namespace enamel::host
