// Three rows of coordinates to one row of vectors.
#pragma once

#include <cstddef>

namespace enamel::pipeline {

/// out: x0 y0 z0 x1 y1 z1 …, 3 * count floats that overlap none of the inputs.
void interleave(const float* x, const float* y, const float* z, std::size_t count, float* out);

}  // namespace enamel::pipeline
