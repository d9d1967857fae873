#include "pipeline/decode/mode_t/four_step_wave.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pipeline/decode/mode_t/chosen.hpp"
#include "pipeline/decode/mode_t/closure_rows.hpp"
#include "pipeline/decode/mode_t/faint.hpp"
#include "pipeline/decode/mode_t/four_step_wave_rows.hpp"
#include "pipeline/decode/phase/wave_tables.hpp"

namespace enamel::pipeline {
namespace {

void set_frames(const SolvedFrames& solved, std::size_t i, PhaseMaps& maps) {
  maps.mean_dn[i] = solved.mean, maps.cosine_dn[i] = solved.cosine;
  maps.sine_dn[i] = solved.sine, maps.code_dn[i] = solved.code;
}

/// The spans of one row after the other, spread over its pixels.
class SpanRow {
 public:
  SpanRow(const WaveOfFrames& in, int width) : in_(in), sign_(static_cast<std::size_t>(width)), wraps_(sign_.size()) {}

  /// Of the next row that has spans; -1: there is none.
  int next() {
    if (at_ == in_.spans.size()) return -1;
    const std::int32_t v = in_.spans[at_].row;
    std::ranges::fill(sign_, 0.0F);
    for (; at_ < in_.spans.size() && in_.spans[at_].row == v; ++at_) {
      const CellSpan& s = in_.spans[at_];
      const auto begin = static_cast<std::size_t>(s.begin), count = static_cast<std::size_t>(s.end - s.begin);
      // A cell without a sign is taken as one of +1.
      std::fill_n(&sign_[begin], count, in_.signs.at(s.cell) < 0 ? -1.0F : 1.0F);
      std::fill_n(&wraps_[begin], count, static_cast<float>(wraps_of_cell(s.cell)));
    }
    return v;
  }
  [[nodiscard]] const float* sign() const noexcept { return sign_.data(); }
  [[nodiscard]] const float* cell_wraps() const noexcept { return wraps_.data(); }

 private:
  const WaveOfFrames& in_;
  std::vector<float> sign_, wraps_;
  std::size_t at_ = 0;
};

}  // namespace

void linearise_four_step(const Waveform& wave, const PhaseConfig& config, PhaseMaps& maps) {
  const PhaseTable three(wave, four_step_three()), four(wave, four_step_four());
  const WaveValues values(wave);
  const Turns at_rest = turns_of<true>({});
  for (std::size_t i = 0; i < maps.phase_rad.size(); ++i) {
    PixelReject& reject = maps.reject[i];
    if (reject != PixelReject::kNone && reject != PixelReject::kNoisy) continue;
    const float a = maps.mean_dn[i], c = maps.cosine_dn[i], s = maps.sine_dn[i], d = maps.code_dn[i];
    const bool plus = std::abs(d + s) > kAlike * maps.modulation_dn[i];  // false for NaN: saturated
    const float s4 = 0.5F * (s + d), shown_rad = plus ? atan2_poly(s4, c) : maps.phase_rad[i];
    const float shown = plus ? root(c * c + s4 * s4) : maps.modulation_dn[i];
    const PhaseTable::Entry e = (plus ? four : three).at(shown_rad);
    const float b = shown * e.scale;
    const Turn turn = turn_of(wrap_once(shown_rad + e.turn_rad));
    const AddedFrames add = added_to(values, turn, b, plus ? -kQuarter : kQuarter, at_rest, {});
    set_frames(less({a, c, s, d}, add), i, maps);
    maps.modulation_dn[i] = root(maps.cosine_dn[i] * maps.cosine_dn[i] + maps.sine_dn[i] * maps.sine_dn[i] + 1e-6F);
    maps.phase_rad[i] = atan2_poly(maps.sine_dn[i], maps.cosine_dn[i]);
    const float by_three_rad = maps.sigma_rad[i], by_four_rad = by_three_rad * (d == d ? fourth_frame_gain(c, s) : 1);
    maps.sigma_rad[i] = widened(by_three_rad, plus ? 1.0F : e.slope, e.spread_rad);
    const bool told = is_told(by_four_rad, maps.sigma_rad[i], config.max_sigma_rad);
    reject = told ? PixelReject::kNone : PixelReject::kNoisy;
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
      if (maps.reject[i] == PixelReject::kNone && !(maps.sigma_rad[i] < kMostAlongFringe * config.max_sigma_rad))
        maps.reject[i] = PixelReject::kNoisy;
    }
  }
}

void take_off_harmonics(const WaveOfFrames& in, const PolarityMaps& polarity, const BurstErrors& errors, float black_dn,
                        PhaseMaps& maps) {
  const WaveValues wave(in.wave);
  ErrorRows rows(errors, black_dn, maps.phase_rad.width());
  SpanRow spans(in, maps.phase_rad.width());
  for (int v = spans.next(); v >= 0; v = spans.next()) {
    const std::size_t i = maps.phase_rad.index(0, v);
    const WaveRow row{.raw_mean = &in.raw.mean_dn[i],
                      .raw_cosine = &in.raw.cosine_dn[i],
                      .raw_sine = &in.raw.sine_dn[i],
                      .raw_code = &in.raw.code_dn[i],
                      .wraps = &polarity.wraps[i],
                      .cell_wraps = spans.cell_wraps(),
                      .sign = spans.sign(),
                      .errors = rows.at(polarity, v),
                      .mean = &maps.mean_dn[i],
                      .cosine = &maps.cosine_dn[i],
                      .sine = &maps.sine_dn[i],
                      .code = &maps.code_dn[i],
                      .phase = &maps.phase_rad[i],
                      .modulation = &maps.modulation_dn[i]};
    take_off_row(row, wave, static_cast<std::size_t>(maps.phase_rad.width()));
  }
}

}  // namespace enamel::pipeline
