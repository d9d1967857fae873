// The loops of surface.hpp over one row. Private to algo/decode.
#pragma once

#include <array>

#include "pipeline/algo/decode/surface.hpp"

namespace enamel::algo {

/// A row's pixels in the images that the surface is solved from, and in the rig's tables.
struct SurfaceRow {
  const float *phase, *cosine, *sine, *sigma;
  const std::int16_t* turn;
  const PixelReject* reject;
  const float *mid, *c0, *c1, *c2, *c3, *ray_x, *ray_y;
};

struct SurfaceRange {
  float q_near, q_far;  ///< 1/z, 1/mm
  float phase_low_rad, phase_high_rad;
};

struct SurfaceRowOut {
  float *inverse_depth, *depth_mm, *sigma_mm, *phase_rad;
  std::uint8_t* order;
  PixelReject* reject;
  float *x_mm, *y_mm;  ///< of the point at that depth
};

/// The ripple's coefficients in float.
struct RippleTerms {
  std::array<float, kRippleTerms> cosine{}, sine{};
};

void solve_surface_row(const SurfaceRow& row, const SurfaceRange& range, const RippleTerms& ripple, std::size_t width,
                       const SurfaceRowOut& out);

/// Every second pixel of a row.
struct SparseSurfaceRow {
  const float* phase;
  const float *mid, *c0, *c1, *c2, *c3;
  const std::int16_t* turn;   ///< of all pixels
  const PixelReject* reject;  ///< of all pixels
};

/// 1/z alone, of count pixels. NaN where rejected or out of range.
void inverse_depth_row(const SparseSurfaceRow& row, const SurfaceRange& range, std::size_t count, float* inverse_depth);

}  // namespace enamel::algo
