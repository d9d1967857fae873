// The loop of inverse_depth.hpp over one row. Private to pipeline/decode.
#pragma once

#include <cstddef>

#include "pipeline/decode/triangulate/inverse_depth.hpp"

namespace enamel::pipeline {

/// Every second pixel of a row.
struct SparseRow {
  const float* phase;
  const float *mid, *c0, *c1, *c2, *c3;
  const std::int16_t* wraps;  ///< of all pixels
  const PixelReject* reject;  ///< of all pixels
};

/// 1/z alone, of count pixels. NaN where rejected or out of range.
void inverse_depth_row(const SparseRow& row, const InverseDepthRange& range, std::size_t count, float* inverse_depth);

}  // namespace enamel::pipeline
