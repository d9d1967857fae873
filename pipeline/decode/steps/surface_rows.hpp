// The loops of surface.hpp over one row. Private to pipeline/decode.
#pragma once

#include <array>

#include "pipeline/decode/steps/surface.hpp"
#include "pipeline/decode/triangulate/inverse_depth.hpp"

namespace enamel::pipeline {

/// A row's pixels in the images that the surface is solved from, and in the rig's tables.
struct SurfaceRow {
  const float *phase, *cosine, *sine, *sigma;
  const std::int16_t* wraps;
  const PixelReject* reject;
  const float *mid, *c0, *c1, *c2, *c3, *ray_x, *ray_y;
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

void solve_surface_row(const SurfaceRow& row, const InverseDepthRange& range, const RippleTerms& ripple,
                       std::size_t width, const SurfaceRowOut& out);

}  // namespace enamel::pipeline
