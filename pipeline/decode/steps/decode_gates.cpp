#include "pipeline/decode/steps/decode_gates.hpp"

#include <algorithm>

#include "pipeline/decode/phase/row_memory.hpp"
#include "pipeline/decode/steps/burst_output.hpp"
#include "pipeline/decode/steps/frame_gate_rows.hpp"
#include "pipeline/decode/steps/frame_gates.hpp"

namespace enamel::pipeline {
namespace {

constexpr int kDirectionRowStep = 4;  // layout: of the rows that are asked: tens of thousands of pairs

}  // namespace

std::size_t count_of(const PhaseMaps& maps, PixelReject reason) noexcept { return count_of(maps.reject, reason); }

std::optional<BurstVerdict> too_few_valid(const PhaseMaps& maps, const LightGate& gate) {
  const std::size_t valid = count_of(maps, PixelReject::kNone);
  if (valid >= gate.min_points) return std::nullopt;
  const std::size_t saturated = count_of(maps, PixelReject::kSaturated), dark = count_of(maps, PixelReject::kDark),
                    noisy = count_of(maps, PixelReject::kNoisy);
  if (valid > saturated + dark + noisy) return BurstVerdict::kTooFewPoints;
  if (saturated >= gate.min_points || saturated > dark + noisy) return BurstVerdict::kSaturated;
  return noisy > dark ? BurstVerdict::kNoFringes : BurstVerdict::kTooDark;
}

BurstVerdict mismatch(const PhaseMaps& maps, const LightGate& gate) {
  const std::size_t saturated = count_of(maps, PixelReject::kSaturated);
  const std::size_t lit = maps.reject.size() - count_of(maps, PixelReject::kDark) - count_of(maps, PixelReject::kNoisy);
  const bool clipped = static_cast<double>(saturated) > gate.max_saturated_share * static_cast<double>(lit);
  return clipped ? BurstVerdict::kSaturated : BurstVerdict::kPatternMismatch;
}

bool frames_go_together(const BurstView& view, std::span<const BurstView> before, const PhaseMaps& maps,
                        const FramesGate& gate, DecodeDiagnostics& diagnostics) {
  const auto left_over = [&](const BurstView& was) { return has_stale_frame(view, was); };
  if (std::ranges::any_of(before, left_over) || has_blank_frame(view, maps, diagnostics.noise)) return false;
  diagnostics.repeated_share = repeated_share(view, maps, diagnostics.noise);
  return diagnostics.repeated_share <= gate.max_repeated_share;
}

bool follows_code(const DecodeDiagnostics& d, const CodeGate& gate) noexcept {
  return d.code_agreement >= gate.min_agreement && d.torn_share <= gate.max_torn_share;
}

bool has_odd_frame(const DecodeDiagnostics& d, const OddFrameGate& gate) noexcept {
  const double share = d.odd_share.value_or(gate.min_share);
  if (share < gate.min_share && d.code_agreement >= gate.sound_agreement) return false;
  const float max_shift_rad = share > gate.most_share ? gate.max_proven_rad : gate.max_shift_rad;
  const float excused_rad = gate.max_over_motion * d.motion_spread_rad + gate.max_over_sigma * d.odd_sigma_rad;
  const bool elsewhere =
      d.odd_shift_rad > max_shift_rad + excused_rad && d.odd_shift_rad > gate.max_over_unrest * d.unrest;
  return elsewhere || d.exposure_step > gate.max_exposure_step + 0.5F * d.odd_sigma_rad;
}

double direction_share(const PhaseMaps& maps, const Carrier& carrier) {
  const auto width = static_cast<std::size_t>(maps.phase_rad.width());
  RowMemory sums(2 * width, 0.0F);
  for (std::size_t at = 0; at < maps.phase_rad.size(); at += kDirectionRowStep * width)
    add_directions_row(maps, carrier.phase_mid_rad, at, width, sums.data());
  double follows = 0, expected = 0;
  for (std::size_t u = 0; u < width; ++u)
    follows += static_cast<double>(sums[u]), expected += static_cast<double>(sums[width + u]);
  return expected > 0 ? 0.5 + 0.5 * std::clamp(follows / expected, -1.0, 1.0) : 0;
}

}  // namespace enamel::pipeline
