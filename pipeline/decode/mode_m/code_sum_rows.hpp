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

/// cosine and sine of 2 pi k/L for k = -last ... last.
struct TurnTable {
  std::vector<float> cosine, sine;
  std::int32_t last = 0;

  explicit TurnTable(const MicroCode& code);
};

/// Turns each pixel's sums by its flood's wrap count, so that they belong to one surface's unwrapped phase; pixels of
/// no component stay.
void unwrap_sums_row(const std::int16_t* wraps, const std::int32_t* component, const TurnTable& table,
                     CodeSumRow& sums);

/// Sums of kStepWindow_px pixels from each pixel on. asked: 1 at the pixels whose left border may hide a jump; 0 where
/// the components at the windows' far ends differ, or where even two independent fits, than which no jump can do
/// better, explain less than `cost` beyond one. It has kRunPadding bytes beyond the row, which stay as they are.
void step_windows_row(const CodeSumRow& sums, const std::int32_t* component, float cost, CodeSumRow& windows,
                      std::uint8_t* asked);

}  // namespace enamel::pipeline
