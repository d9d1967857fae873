// The loops of find_segments over one row.
#pragma once

#include <cstddef>
#include <cstdint>

#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/decode/unwrap/chosen.hpp"
#include "pipeline/decode/unwrap/flood.hpp"

namespace enamel::pipeline {

/// What a pixel is to the segments of its row.
enum PixelMark : std::uint8_t {
  kInside,      ///< continues the segment of the pixel before it
  kHole,        ///< in no component
  kFirst,       ///< begins a run
  kNextCell,    ///< continues the run in another half fringe
  kAfterKink,   ///< continues the run across a step or a cut
  kAfterShade,  ///< continues the run across a step of the modulation only
};

/// What lies between a pixel and the one before it, as bits.
enum PixelBorder : std::uint8_t { kKink = 1, kShade = 2 };

/// A row's pixels.
struct FloodRow {
  const float* phase;
  const std::int16_t* wraps;
  const std::int32_t* component;
  const std::uint8_t* east;
};

/// phase + 2 pi wraps; NaN outside all components.
void unwrap_row(const FloodRow& row, std::size_t width, float* phi);

/// kinks: 1 where a step lies between a pixel and the one before it, once, where it is highest. heights: scratch.
void kink_row(const float* phi, const float* sigma, std::size_t width, float* heights, std::uint8_t* kinks);

/// A row among its neighbours: pointers to its first pixel, which rows `above` of it and `below` of it must exist
/// around.
struct ShadeRows {
  const float* modulation;
  const float* sigma;
  const std::int32_t* component;
  int above, below;
};

/// Adds kShade to borders where the modulation steps between a pixel and the one before it, once, where the step is
/// highest: by more than a fifth, and than noise explains, in the mean over the rows. It may be texture; it may be
/// another surface that the phase does not tell from this one. mean, heights: scratch.
void shade_row(const ShadeRows& rows, std::size_t width, float* mean, float* heights, std::uint8_t* borders);

void mark_row(const FloodRow& row, const float* phi, const std::uint8_t* kinks, std::size_t width, std::uint8_t* marks);

/// What the columns of a border between two rows say about a step there, to be summed over a segment's columns.
struct BorderColumn {
  float height = 0;  ///< of the step, as excess over the slopes above and below; 0 where there is nothing to compare
  float sigma = 0;   ///< of the lower pixel where there is
  float seen = 0;    ///< 1 there
  float linked = 0;  ///< 1 where both pixels are on one surface
};

/// Between the row of `phi` and `sigma` and the one above it: rows -5 … 4 of phi must exist when `room` is set, else
/// no height is taken. south: links of the upper row.
void border_row(const float* phi, const float* sigma, const std::uint8_t* south, bool room, std::size_t width,
                BorderColumn* out);

/// Rounded down, as std::floor is, without its call.
[[nodiscard]] inline std::int32_t floor_of(float x) noexcept {
  const auto whole = static_cast<std::int32_t>(x);
  return whole - static_cast<std::int32_t>(static_cast<float>(whole) > x);
}

/// Smallest step that is neither noise (4 sigma of six samples' combination) nor ripple of the three-frame phase.
[[nodiscard]] inline float step_threshold(float sigma, float samples) noexcept {
  return 4 * root(6.0F / samples) * sigma + kLeastStep;
}

}  // namespace enamel::pipeline
