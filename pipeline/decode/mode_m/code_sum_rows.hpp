// The loops of micro_evidence.hpp and code_steps.hpp over one row. Private to pipeline/decode.
#pragma once

#include "pipeline/decode/mode_m/chosen.hpp"
#include "pipeline/decode/mode_m/micro_evidence.hpp"

namespace enamel::pipeline {

/// Pixels that are looked at on either side of a border.
inline constexpr std::size_t kStepReach_px = kStepGap_px + kStepWindow_px;

/// layout: keeps two fits from dividing by 0 where pixels have no code.
inline constexpr float kStepRidge = 1e-2F;

/// Reduction of the sum of squares by the best z: h N^-1 h.
[[nodiscard]] inline float explained(const CodeSums& s) noexcept {
  const float a = s.xx + kStepRidge, d = s.yy + kStepRidge;
  return (d * s.xd * s.xd - 2 * s.xy * s.xd * s.yd + a * s.yd * s.yd) / (a * d - s.xy * s.xy);
}

/// The sums of w exp(i turn): as if the pixels lay some orders on. c, n: cosine and sine of the turn.
[[nodiscard]] inline CodeSums turned(const CodeSums& s, float c, float n) noexcept {
  // x = Re w, y = -Im w: x' = c x + n y, y' = c y - n x.
  return {c * c * s.xx + 2 * c * n * s.xy + n * n * s.yy,
          (c * c - n * n) * s.xy + c * n * (s.yy - s.xx),
          n * n * s.xx - 2 * c * n * s.xy + c * c * s.yy,
          c * s.xd + n * s.yd,
          c * s.yd - n * s.xd,
          s.dd};
}

/// As code_sums_of_row, but of w = B exp(i(phi + Phi/L)) with the flood's Phi, so that pixels of one surface have one z
/// whatever their fringe. wraps: the row's; of no meaning, as the sums are then, where there is no component.
void unwrapped_sums_of_row(const PhaseMaps& phase, const NoiseModel& noise, const MicroCode& code,
                           const std::int16_t* wraps, std::size_t row, CodeSumRow& out);

/// layout: half of the code ratio of 7, rounded down: a jump of more orders looks like one of these.
inline constexpr std::size_t kMostJump = 3;
inline constexpr float kNoJump = 1e30F;  ///< layout: above any misfit

/// Borders that may hide a jump, with the sums of the windows on either side.
struct StepCandidates {
  CodeSumRow left, right;
  std::vector<float> misfit;

  void resize(std::size_t count);
};

/// misfit: half the squares that the best jump of up to kMostJump orders leaves unexplained; kNoJump unless it is a
/// better explanation than none by `cost`. The code has kMostJump orders at least.
void find_misfits(const MicroCode& code, float cost, StepCandidates& candidates);

/// Sums of kStepWindow_px pixels from each pixel on, and what they explain. asked: 1 at the pixels whose left border
/// may hide a jump; 0 where the components at the windows' far ends differ, or where even two independent fits, than
/// which no jump can do better, explain less than `cost` beyond one. It has kRunPadding bytes beyond the row, which
/// stay as they are.
struct StepWindows {
  CodeSumRow sums;
  std::vector<float> explained;
};
void step_windows_row(const CodeSumRow& sums, const std::int32_t* component, float cost, StepWindows& windows,
                      std::uint8_t* asked);

}  // namespace enamel::pipeline
