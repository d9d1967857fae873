// The loops of rigid_motion.hpp: over nodes of a row and all that judge the motion. Private to
// pipeline/decode.
#pragma once

#include <array>
#include <cstddef>

#include "pipeline/decode/motion/motion_images.hpp"
#include "pipeline/decode/motion/motion_samples.hpp"

namespace enamel::pipeline {

/// Slopes of 1/z and of A about the nodes of a row, per pixel, from pairs of pixels opposite to each other: holes and
/// edges drop out. All arrays hold one value a node.
struct SlopeRow {
  const float* limit;                  ///< steps of 1/z per pixel beyond this are no surface's
  float *det, *q_u, *q_v, *a_u, *a_v;  ///< det: of the 2x2 normal equations; slopes are to be divided by it
};
void slope_row(const MotionImages& images, int node_row, int begin, int end, const SlopeRow& out);

/// What the pixels of a SampleRow say; rate_per_rate is not written.
void known_row(const SampleRow& row, std::size_t count, float max_residual, const SampledResiduals& out);

/// Sums over the samples: normal equations of (V, W, rho), residuals beyond `limit` left out.
void add_samples(const MotionSamples& samples, const MotionColumns& columns, const std::array<double, 7>& theta,
                 double limit, MotionEquations& out);

}  // namespace enamel::pipeline
