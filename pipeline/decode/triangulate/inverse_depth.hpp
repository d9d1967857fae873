// 1/z of some pixels before the phase is final, for whoever needs slopes; and what depths count.
#pragma once

#include <cstdint>

#include "pipeline/decode/phase/phase.hpp"
#include "pipeline/decode/triangulate/ray_depth.hpp"
#include "pipeline/types/map.hpp"

namespace enamel::pipeline {

struct InverseDepthRange {
  float q_near, q_far;  ///< 1/z, 1/mm
  float phase_low_rad, phase_high_rad;
};

/// beyond: share by which the range is wider.
[[nodiscard]] InverseDepthRange depth_range_of(const RayDepth& rays, float beyond = 0) noexcept;

/// What 1/z is taken from. Borrowed.
struct SparseDepth {
  const PhaseMaps& maps;           ///< their mask
  const Map<std::int16_t>& wraps;  ///< Phi = phase + 2 pi wraps
  const RayDepth& rays;
  float beyond = 0;  ///< share by which the depth range is wider
};

/// 1/z of every second pixel of image row v, an even one; NaN where rejected or out of range. phase_rad: of these
/// pixels.
void sparse_inverse_depth_row(const SparseDepth& of, int v, const float* phase_rad, float* inverse_depth);

}  // namespace enamel::pipeline
