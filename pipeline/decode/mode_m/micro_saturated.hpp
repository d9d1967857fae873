// Mode M's pixels with one saturated phase frame, solved from the two others and the code frame. These are three
// equations for A, B and phi, but the code frame speaks of the order as well as of the phase, so the order must be
// known (docs/decode.md §1): it is that of the surface on both sides of the saturated run, where one continues the
// other as a surface that faces the camera would. The neighbours tell the order and where to start, nothing else: phase
// and its sigma are the pixel's own.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pipeline/decode/mode_m/micro_refit.hpp"
#include "pipeline/decode/phase/cell_span.hpp"

namespace enamel::pipeline {

struct MicroSaturatedInput {
  std::span<const CellSpan> spans;  ///< decided ones
  const MicroCode& code;
  const MicroMotion& motion;  ///< of every pixel
  float third_rad;            ///< a1 of micro_phase.hpp
  const NoiseModel& noise;
  const float* carrier_rad;  ///< Phi of a surface that faces the camera, per pixel
};

/// After undo_micro_motion and join_code_frame, which leave saturated pixels as compute_micro_phase did. Of each run of
/// kSaturated pixels of a row between decided ones, fills phase, sigma, mean, cosine, sine, modulation and wrap count
/// of those that can be solved to max_sigma_rad and rewrites their reject as kNone. Returns their indices in `solved`.
void solve_micro_saturated(const MicroSaturatedInput& input, const PhaseConfig& config, PhaseMaps& maps,
                           Map<std::int16_t>& wraps, std::vector<std::size_t>& solved);

}  // namespace enamel::pipeline
