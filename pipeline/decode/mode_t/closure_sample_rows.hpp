// The loop of FourStepView over the sampled pixels of a row. Private to pipeline/decode.
#pragma once

#include "pipeline/decode/mode_t/motion_pixels.hpp"
#include "pipeline/decode/motion/motion_samples.hpp"

namespace enamel::pipeline {

/// What the closure residual, polarity undone, says of a burst at rest (closure.hpp).
void closure_sample_row(const SampledRow& pixels, float black_dn, float max_residual, const SampledResiduals& out);

}  // namespace enamel::pipeline
