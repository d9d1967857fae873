#include "pipeline/decode/mode_t/four_step_wave.hpp"

#include <array>
#include <cmath>
#include <optional>

#include "pipeline/decode/mode_t/chosen.hpp"
#include "pipeline/decode/mode_t/closure_rows.hpp"
#include "pipeline/decode/phase/frame_turns.hpp"
#include "pipeline/decode/phase/wave_tables.hpp"

namespace enamel::pipeline {
namespace {

constexpr Turn kQuarter{0, 1}, kHalf{-1, 0};  // layout: of a fringe, from frame to frame

/// What harmonics add to the four frames of one pixel. turn: of its phase at mid-burst; b: sign of frame 3.
std::array<float, 4> added_to(const WaveValues& wave, const Turn& turn, float modulation, float b,
                              const PixelChange& change) {
  const Turns t = turns_of<false>(change);
  const Turn last = b < 0 ? kQuarter : -kQuarter;
  return {modulation * wave.at((turn + t.a0).cos) * change.light(-1.5F),
          modulation * wave.at((turn + kQuarter + t.a1).cos) * change.light(-0.5F),
          modulation * wave.at((turn + kHalf + t.a2).cos) * change.light(0.5F),
          modulation * wave.at((turn + last + t.a3).cos) * change.light(1.5F)};
}

/// A, C, S and D of four frames, solved by the first three.
struct Solved {
  float mean, cosine, sine, code;
};

/// The same frames less what is in them beside a cosine.
void set_frames(const Solved& raw, const std::array<float, 4>& add, std::size_t i, PhaseMaps& maps) {
  const float a = raw.mean - 0.5F * (add[0] + add[2]);
  maps.mean_dn[i] = a;
  maps.cosine_dn[i] = raw.cosine - 0.5F * (add[0] - add[2]);
  maps.sine_dn[i] = a - (raw.mean - raw.sine - add[1]);
  maps.code_dn[i] = raw.mean + raw.code - add[3] - a;
}

}  // namespace

void linearise_four_step(const Waveform& wave, const PhaseConfig& config, PhaseMaps& maps) {
  const PhaseTable by_three(wave, four_step_three()), by_four(wave, four_step_four());
  const WaveValues values(wave);
  for (std::size_t i = 0; i < maps.phase_rad.size(); ++i) {
    PixelReject& reject = maps.reject[i];
    if (reject != PixelReject::kNone && reject != PixelReject::kNoisy) continue;
    const float a = maps.mean_dn[i], c = maps.cosine_dn[i], s = maps.sine_dn[i], d = maps.code_dn[i];
    const bool plus = std::abs(d + s) > kAlike * maps.modulation_dn[i];  // false for NaN: saturated
    const float s4 = 0.5F * (s + d), shown_rad = plus ? atan2_poly(s4, c) : maps.phase_rad[i];
    const float shown = plus ? root(c * c + s4 * s4) : maps.modulation_dn[i];
    const PhaseTable::Entry e = (plus ? by_four : by_three).at(shown_rad);
    const float b = shown * e.scale;
    const Turn turn = turn_of(wrap_once(shown_rad + e.turn_rad));
    const auto add = added_to(values, turn, b, plus ? 1.0F : -1.0F, {});
    set_frames({a, c, s, d}, add, i, maps);
    maps.modulation_dn[i] = root(maps.cosine_dn[i] * maps.cosine_dn[i] + maps.sine_dn[i] * maps.sine_dn[i] + 1e-6F);
    maps.phase_rad[i] = atan2_poly(maps.sine_dn[i], maps.cosine_dn[i]);
    maps.sigma_rad[i] = widened(maps.sigma_rad[i], plus ? 1.0F : e.slope, e.spread_rad);
    reject = maps.sigma_rad[i] < config.max_sigma_rad ? PixelReject::kNone : PixelReject::kNoisy;
  }
}

void widen_by_wave(std::span<const CellSpan> spans, const CellSigns& signs, const Waveform& wave,
                   const PhaseConfig& config, PhaseMaps& maps) {
  const WaveWidening widening(wave, four_step_three());
  for (const CellSpan& s : spans) {
    if (signs.at(s.cell) > 0) continue;
    for (std::int32_t u = s.begin; u < s.end; ++u) {
      const std::size_t i = maps.phase_rad.index(u, s.row);
      const auto [factor, spread_rad] = widening.at(wrap_once(maps.phase_rad[i]));
      maps.sigma_rad[i] = widened(maps.sigma_rad[i], factor, spread_rad);
      if (maps.reject[i] == PixelReject::kNone && !(maps.sigma_rad[i] < config.max_sigma_rad))
        maps.reject[i] = PixelReject::kNoisy;
    }
  }
}

void take_off_harmonics(const WaveOfFrames& in, const PolarityMaps& polarity, const BurstErrors& errors, float black_dn,
                        PhaseMaps& maps) {
  const WaveValues wave(in.wave);
  ErrorRows rows(errors, black_dn, maps.phase_rad.width());
  std::optional<RowErrors> row;
  std::int32_t at_row = -1;
  for (const CellSpan& s : in.spans) {
    if (s.row != at_row) row = rows.at(polarity, s.row);
    at_row = s.row;
    const float b = in.signs.at(s.cell);
    const int wraps = wraps_of_cell(s.cell);
    for (std::int32_t u = s.begin; u < s.end; ++u) {
      const std::size_t i = maps.phase_rad.index(u, s.row);
      const float phase = maps.phase_rad[i] + kTwoPiF * static_cast<float>(polarity.wraps[i] - wraps);
      const auto add =
          added_to(wave, turn_of(wrap_once(phase)), maps.modulation_dn[i], b, row->change(static_cast<std::size_t>(u)));
      set_frames({in.raw.mean_dn[i], in.raw.cosine_dn[i], in.raw.sine_dn[i], in.raw.code_dn[i]}, add, i, maps);
      maps.phase_rad[i] =
          phase + wrap_once(wrap_once(atan2_poly(maps.sine_dn[i], maps.cosine_dn[i]) - wrap_once(phase)));
    }
  }
}

}  // namespace enamel::pipeline
