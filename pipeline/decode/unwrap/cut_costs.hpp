// What it costs to cut an image between two neighbouring pixels, for unwrapping without a code: the logarithm of how
// much likelier their phases are on one surface than across a jump that may be anything.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/decode/phase/phase.hpp"
#include "pipeline/decode/unwrap/links.hpp"

namespace enamel::pipeline {

struct CutConfig {
  /// Links on one surface for every link across a jump: the only prior. chosen: on crowns, whose cliffs cross about one
  /// link in a thousand of a burst.
  float links_per_jump = 1000;
  /// chosen: by judgement. Rms change of slope from pixel to pixel: radii down to a quarter millimetre.
  float curvature_rad = 0.03F;
  /// chosen: by judgement. Steeper differences to the next pixel but one say nothing of the slope here.
  float max_slope_rad = 1;
};

inline constexpr int kCostPerNat = 8;  ///< layout: costs are bytes
/// layout: of any cut between valid pixels: among equals the shorter one is better.
inline constexpr int kLeastCost = 1;

/// Maps with a margin of one pixel all round, valid = 0 there: every pixel of the image has four neighbours and four
/// quads. Index of pixel (u, v): (v + 1) stride + u + 1.
struct CutCosts {
  std::size_t stride = 0, rows = 0;
  std::vector<std::uint8_t> valid;  ///< with kRunPadding bytes of 255 behind
  /// Turns that the phase gains to the right / lower neighbour where it wraps between them; 0 beside invalid pixels.
  std::vector<std::int8_t> east_turn, south_turn;
  /// Of a cut between the pixel and its right / lower neighbour; 0 beside invalid pixels, kLeastCost … 255 elsewhere.
  std::vector<std::uint8_t> east_cost, south_cost;
  Map<PixelReject> reject;  ///< the burst's, with noisy pixels and those at edges as valid ones
  std::vector<float> scratch;
};

/// With e = W(phi_j - phi_i) less the carrier's step, x = e less the mean of e on both sides along the same line, and
/// s^2 its variance (5 sigma^2 of four pixels, 6 of three, 2 and any slope of two, and the curvature's):
///   cost = ln(2 pi / (sqrt(2 pi) s)) + ln(links_per_jump) - x^2 / 2 s^2
/// in steps of 1/kCostPerNat, not below kLeastCost. carrier: of the maps' size, slopes as for compute_links.
void measure_cut_costs(const PhaseMaps& phase, const Carrier& carrier, const CutConfig& config, CutCosts& out);

}  // namespace enamel::pipeline
