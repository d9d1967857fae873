// The loop of sight_cells.hpp over a row. Private to pipeline/decode.
#pragma once

#include <cstddef>

#include "pipeline/decode/phase/noise_model.hpp"
#include "pipeline/decode/phase/phase.hpp"

namespace enamel::pipeline {

/// layout: sums of an image column over some rows; all that follow in kLit… are those of lit pixels.
enum SightSum : std::size_t {
  kMeasured,
  kSaturated,
  kLight,
  kFringe2,
  kNoise2,
  kLit,
  kLitCosine,
  kLitSine,
  kLitLight,
};
inline constexpr std::size_t kSightSums = kLitLight + 1;  ///< layout: arrays of `width` floats

/// Adds the row that begins at pixel `at` of the maps.
void add_sight_row(const PhaseMaps& maps, const NoiseModel& noise, std::size_t at, std::size_t width, float* sums);

}  // namespace enamel::pipeline
