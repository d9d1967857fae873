// The loops of light_change.hpp over the pixels of a row. Private to pipeline/decode.
#pragma once

#include <cstddef>

#include "pipeline/decode/phase/block_fit.hpp"
#include "pipeline/decode/phase/light_change.hpp"

namespace enamel::pipeline {

/// layout: columns of a pixel's two equations, which BlockFit solves; what they say, and their weight.
enum LightColumn : std::size_t {
  kCosine,
  kSine,
  kRest,
  kGain,
  kAlong,
  kAcross,
  kCosine2,
  kSine2,
  kLevel,
  kSaid,
  kLightWeight,
};
inline constexpr std::size_t kLightColumns = kLightWeight + 1;  ///< layout: rows of a stretch

/// Where BlockFit keeps the product of columns i <= j.
[[nodiscard]] constexpr std::size_t light_sum_of(std::size_t i, std::size_t j) {
  return i * (kSaid + 1) - i * (i - 1) / 2 + (j - i);
}
inline constexpr std::size_t kLightCount = light_sum_of(kSaid, kSaid) + 1;  ///< layout: and the number of pixels
static_assert(kLightCount + 1 == BlockFit<kSaid>::kSums);

/// Adds the products of what B/A of a row says to the sums of its columns. stretch: scratch of kLightColumns rows, in
/// which kAlong, kAcross and kLevel are filled.
void add_lamp_fringe_row(const LightRow& row, LampLight of, std::size_t width, float* stretch, float* sums);

/// The same of the fourth frame off its prediction, over A.
void add_lamp_rest_row(const LightRow& row, LampLight of, std::size_t width, float* stretch, float* sums);

}  // namespace enamel::pipeline
