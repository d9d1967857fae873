// The loops of compute_normals over one row. Private to algo/triangulate.
#pragma once

#include "pipeline/algo/triangulate/normals.hpp"

namespace enamel::algo {

struct PixelOffset {
  int du, dv;
};

/// Sums of the 2x2 normal equations of one row, five arrays of the row's length.
struct NormalSums {
  float *uu, *uv, *vv, *u, *v;
};

struct RowGeometry {
  const float *x, *y;
  float per_px_x, per_px_y;  ///< change of the normalised coordinate per pixel
};

/// Adds the difference plus - minus of 1/z at twice the offset, where it is below limit times the offset's length.
void add_normal_pair(const float* plus, const float* minus, const float* limit, PixelOffset o, int begin, int end,
                     const NormalSums& s);

/// Unit normals towards the camera; NaN where the pairs do not span a plane. q: 1/z.
void solve_normal_row(const NormalSums& s, const float* q, const RowGeometry& g, int width, Vec3f* out);

}  // namespace enamel::algo
