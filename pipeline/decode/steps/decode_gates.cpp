#include "pipeline/decode/steps/decode_gates.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/decode/phase/row_memory.hpp"
#include "pipeline/decode/steps/burst_output.hpp"
#include "pipeline/decode/steps/chosen.hpp"
#include "pipeline/decode/steps/frame_gate_rows.hpp"
#include "pipeline/decode/steps/frame_gates.hpp"

namespace enamel::pipeline {
namespace {

/// Beyond what motion, noise and the burst's unrest excuse.
bool shifted_beyond(const DecodeDiagnostics& d, const OddFrameGate& gate, float max_shift_rad) noexcept {
  const float excused_rad = gate.max_over_motion * d.motion_spread_rad + gate.max_over_sigma * d.odd_sigma_rad;
  return d.odd_shift_rad > max_shift_rad + excused_rad && d.odd_shift_rad > gate.max_over_unrest * d.unrest;
}

constexpr std::size_t kDirectionRowStep = 4;  // layout: of the rows that are asked: tens of thousands of pairs

/// How far apart two pixels must be for noise to leave the sign of the carrier's step between them.
std::size_t pixels_apart(const PhaseMaps& maps, const float* carrier_rad) {
  constexpr std::size_t kEvery = 37;  // layout: of all pixels, one; no column twice in a row
  const auto width = static_cast<std::size_t>(maps.phase_rad.width());
  double step = 0, noise2 = 0, seen = 0;
  for (std::size_t i = 0; i + 1 < maps.phase_rad.size(); i += kEvery) {
    if (maps.reject[i] != PixelReject::kNone || (i + 1) % width == 0) continue;
    step += std::abs(static_cast<double>(carrier_rad[i + 1]) - static_cast<double>(carrier_rad[i]));
    noise2 += 2.0 * static_cast<double>(maps.sigma_rad[i]) * static_cast<double>(maps.sigma_rad[i]);
    seen += 1;
  }
  if (!(step > 0)) return 1;
  step /= seen;
  const double wanted_rad = std::min(kSignSigmas * std::sqrt(noise2 / seen), kMostStep_rad);
  return static_cast<std::size_t>(std::clamp(std::floor(wanted_rad / step), 1.0, static_cast<double>(width - 1)));
}

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

bool could_be_projected(const DecodeDiagnostics& d, const WaveGate& gate) noexcept {
  return std::abs(d.wave.harmonic[1]) <= gate.max_third;
}

bool follows_code(const DecodeDiagnostics& d, const CodeGate& gate) noexcept {
  return d.code_agreement >= gate.min_agreement && d.torn_share <= gate.max_torn_share;
}

bool has_odd_frame(const DecodeDiagnostics& d, const OddFrameGate& gate) noexcept {
  if (d.unrest > gate.max_unrest) return true;
  const double share = d.odd_share.value_or(gate.min_share);
  if (share < gate.min_share && d.code_agreement >= gate.sound_agreement) return false;
  const float max_shift_rad = share > gate.most_share ? gate.max_proven_rad : gate.max_shift_rad;
  return shifted_beyond(d, gate, max_shift_rad) || d.exposure_step > gate.max_exposure_step + 0.5F * d.odd_sigma_rad;
}

bool may_have_odd_frame(const DecodeDiagnostics& d, const OddFrameGate& gate) noexcept {
  return shifted_beyond(d, gate, gate.max_shift_rad);
}

double direction_share(const PhaseMaps& maps, const Carrier& carrier) {
  const auto width = static_cast<std::size_t>(maps.phase_rad.width());
  RowMemory sums(2 * width, 0.0F);
  const RowPairs pairs{width, pixels_apart(maps, carrier.phase_mid_rad)};
  for (std::size_t at = 0; at < maps.phase_rad.size(); at += kDirectionRowStep * width)
    add_directions_row(maps, carrier.phase_mid_rad, at, pairs, sums.data());
  double follows = 0, expected = 0;
  for (std::size_t u = 0; u < width; ++u)
    follows += static_cast<double>(sums[u]), expected += static_cast<double>(sums[width + u]);
  return expected > 0 ? 0.5 + 0.5 * std::clamp(follows / expected, -1.0, 1.0) : 0;
}

}  // namespace enamel::pipeline
