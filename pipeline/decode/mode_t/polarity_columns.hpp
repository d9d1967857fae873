// The loops of PolarityEvidence: over the pixels of a row and over segments. Private to pipeline/decode.
#pragma once

#include <cstddef>

#include "pipeline/decode/mode_t/polarity_evidence.hpp"
#include "pipeline/decode/phase/noise_model.hpp"

namespace enamel::pipeline {

/// What a row's pixels add to a segment's sums, from column 0 on; 0 where frame 3 is saturated.
void polarity_columns(const PhaseMaps& phase, const NoiseModel& noise, std::size_t at, std::size_t width,
                      PolarityColumn* out);

/// Cost of T under each sign: Gaussian about the sign, or with small probability anything in a width of 3. A sharp T
/// can contradict more strongly than a blurred one; one that says nothing costs nothing.
void price_polarity(float outlier_cost, std::size_t count, PolaritySaid* said);

}  // namespace enamel::pipeline
