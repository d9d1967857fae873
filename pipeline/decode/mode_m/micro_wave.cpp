#include "pipeline/decode/mode_m/micro_wave.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <array>
#include <cmath>

#include "pipeline/decode/mode_m/chosen.hpp"
#include "pipeline/decode/mode_m/micro_spans.hpp"
#include "pipeline/decode/mode_m/micro_wave_pixel.hpp"
#include "pipeline/decode/mode_m/micro_wave_rows.hpp"
#include "pipeline/decode/phase/wave_tables.hpp"

namespace enamel::pipeline {
namespace {

using WaveUnknowns = Eigen::Vector4d;  ///< dhc_2, dhc_3, dh_2, dh_3

struct NormalEquations {
  Eigen::Matrix4d square = Eigen::Matrix4d::Zero();
  WaveUnknowns side = WaveUnknowns::Zero();

  void add(const WaveUnknowns& columns, double residual, double weight) {
    square += weight * columns * columns.transpose();
    side += weight * residual * columns;
  }
};

void add_pixel(const CodeRow& row, std::size_t u, float max_residual, const NoiseModel& noise, NormalEquations& out) {
  const PixelChange change = change_of(row, u);
  const Pixel raw{row.pixels.mean[u] - row.black_dn, row.pixels.cosine[u], row.pixels.sine[u]};
  const Residual r = code_residual<false>(raw, row.pixels.code[u], row.pixels.phase[u], row.wraps[u], change,
                                          row.gain[u], {row.inverse_ratio, 0});
  if (!(std::abs(r.rest) < max_residual * r.modulation)) return;
  const WavePixel s = see_pixel(row, u, lights_of<false>(change), turns_of<false>(change));
  const float ratio = 1 + row.inverse_ratio, gain = row.gain[u];
  const Turn code = code_turn(row, u, s, change);
  const float c1 = s.pixel.cosine / s.modulation, s1 = s.pixel.sine / s.modulation;
  const float c3 = thrice(c1), s3 = s1 * (3 - 4 * s1 * s1), c = code.cos;
  const std::array<float, 4> columns = {twice(c), thrice(c), -gain * (c3 * c + ratio * s3 * code.sin), -c3};
  WaveUnknowns x;
  for (std::size_t k = 0; k < columns.size(); ++k)
    x(static_cast<Eigen::Index>(k)) = static_cast<double>(s.modulation * columns[k]);
  out.add(x, static_cast<double>(r.rest), 1 / static_cast<double>(noise.variance(row.pixels.mean[u])));
}

}  // namespace

void linearise_micro(const Waveform& wave, const PhaseConfig& config, PhaseMaps& maps) {
  const PhaseTable phases(wave, micro_three_step());
  const LevelTable levels(wave);
  for (std::size_t i = 0; i < maps.phase_rad.size(); ++i) {
    PixelReject& reject = maps.reject[i];
    if (reject != PixelReject::kNone && reject != PixelReject::kNoisy) continue;
    const PhaseTable::Entry e = phases.at(maps.phase_rad[i]);
    const float b = maps.modulation_dn[i] * e.scale, lift = maps.modulation_dn[i] * e.mean;
    const float phi = wrap_once(maps.phase_rad[i] + e.turn_rad);
    const Turn turn = turn_of(phi);
    maps.phase_rad[i] = phi, maps.modulation_dn[i] = b, maps.mean_dn[i] += lift;
    maps.cosine_dn[i] = b * turn.cos, maps.sine_dn[i] = b * turn.sin;
    maps.code_dn[i] = b * levels.cosine_of((maps.code_dn[i] - lift) / b);
    const float by_light_rad = maps.sigma_rad[i];
    maps.sigma_rad[i] = widened(by_light_rad, e.slope, e.spread_rad);
    const bool told = is_told(by_light_rad, maps.sigma_rad[i], config.max_sigma_rad);
    reject = told ? PixelReject::kNone : PixelReject::kNoisy;
  }
}

void take_off_harmonics(const RawFrames& raw, const Map<std::int16_t>& wraps, const MicroCode& code,
                        const MicroMotion& motion, const MicroWave& wave, PhaseMaps& maps) {
  const WaveValues fringe(wave.fringe), finer(wave.code);
  CodeRows rows(motion, maps, &wraps);
  rows.expect(code, 0);
  const auto width = static_cast<std::size_t>(wraps.width());
  for (int v = 0; v < wraps.height(); ++v) {
    const std::size_t at = maps.phase_rad.index(0, v);
    const StraightRow out{&maps.mean_dn[at], &maps.cosine_dn[at],     &maps.sine_dn[at],
                          &maps.code_dn[at], &maps.modulation_dn[at], &maps.phase_rad[at]};
    take_off_row(rows.at(v), {&raw.mean_dn[at], &raw.cosine_dn[at], &raw.sine_dn[at], &raw.code_dn[at]}, fringe, finer,
                 width, out);
  }
}

MicroWave refit_wave(const MicroBurst& burst, const MicroMotion& motion, float max_residual, const MicroWave& wave) {
  NormalEquations sums;
  CodeRows rows(motion, burst.maps, &burst.wraps);
  rows.expect(burst.code, 0);
  for (int v = 0; v < burst.wraps.height(); v += kWaveRowStep) {
    const CodeRow row = rows.at(v);
    for (std::size_t u = 0; u < static_cast<std::size_t>(burst.wraps.width()); ++u)
      if (row.wraps[u] > kUnplaced) add_pixel(row, u, max_residual, burst.noise, sums);
  }
  const double precision = 1 / (kWaveSpread * kWaveSpread);
  const WaveUnknowns step = (sums.square + precision * Eigen::Matrix4d::Identity()).llt().solve(sums.side);
  MicroWave out = wave;
  out.code.harmonic[0] += step(0), out.code.harmonic[1] += step(1);
  out.fringe.harmonic[0] += step(2), out.fringe.harmonic[1] += step(3);
  return out;
}

}  // namespace enamel::pipeline
