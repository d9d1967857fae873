// The inner loops of SurfelMap, a row at a time. Private to model/fuse.
#pragma once

namespace enamel::pipeline {

/// Of every stride-th pixel of a row, `count` of them from element `first` on, the mean with its neighbours along the
/// row where they continue it within the noise, and 3; else the pixel itself and 1.
struct RowMeans {
  const float* depth;  ///< at pixel 0
  const float* sigma;  ///< likewise
  int stride, first, count;
  float* mean;     ///< at element 0
  float* support;  ///< likewise
};
void average_along_row(const RowMeans& row);

/// The same across rows, of what average_along_row() made of three of them; sigma: of the middle row, every stride-th.
struct ColumnMeans {
  const float *above, *here, *below, *support_here, *sigma;
  int stride, count;
  float *mean, *support;
};
void average_across_rows(const ColumnMeans& rows);

/// Weights of a row of surfels. dot: point . normal, mm.
struct SurfelLimits {
  float cos_min, sigma_ref2, weight_max;
};
struct SurfelCounts {
  int used = 0, steep = 0;
};
[[nodiscard]] SurfelCounts weigh_surfels(const float* dot, const float* z, const float* sigma, const float* cos_to_axis,
                                         const SurfelLimits& limits, int count, float* per_depth, float* weight);

}  // namespace enamel::pipeline
