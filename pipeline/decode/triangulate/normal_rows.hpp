// The loop of compute_normals over one row. Private to pipeline/decode.
#pragma once

#include <array>

#include "pipeline/decode/triangulate/chosen.hpp"
#include "pipeline/decode/triangulate/normals.hpp"

namespace enamel::pipeline {

/// Rows v-3 … v+3 of 1/z, each with kNormalReach_px readable floats before and behind: NaN there and in rows beyond
/// the image.
using NormalWindow = std::array<const float*, 2 * kNormalReach_px + 1>;

struct RowGeometry {
  const float *x, *y;
  float per_px_x, per_px_y;  ///< change of the normalised coordinate per pixel
  float max_slope;           ///< of z over lateral distance, tangent
};

/// Components of the unit normals of a row.
struct NormalRow {
  float *x, *y, *z;
};

/// Unit normals towards the camera of the window's middle row; NaN where the pairs do not span a plane. sigma_mm: of
/// the depth.
void normals_of_row(const NormalWindow& window, const float* sigma_mm, const RowGeometry& geometry, int width,
                    const NormalRow& out);

}  // namespace enamel::pipeline
