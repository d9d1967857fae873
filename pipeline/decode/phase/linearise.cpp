#include "pipeline/decode/phase/linearise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/decode/phase/poly_trig.hpp"

namespace enamel::pipeline {
namespace {

constexpr std::size_t kPhases = 1024, kFine = 4096, kLevels = 1024;  // layout: linear between; errors below 1e-4 rad
/// chosen: by judgement. Of true phase over the phase shown, and of F; with less noise is amplified fourfold.
constexpr double kLeastSlope = 0.25;
constexpr double kBeyond = 0.25;  ///< chosen: by judgement. Of a level, above and below the wave's own: noise.

}  // namespace

Lineariser::Lineariser(const Waveform& wave, const ThreeStep& frames) {
  tabulate_phase(wave, frames);
  tabulate_level(wave);
}

void Lineariser::tabulate_phase(const Waveform& wave, const ThreeStep& frames) {
  const SeenWave seen = see(wave, frames, kFine);
  by_phase_.resize(kPhases + 1);
  const auto shown = [&](std::size_t i) {
    return static_cast<double>(
        atan2_poly(static_cast<float>(seen.sine[i % kFine]), static_cast<float>(seen.cosine[i % kFine])));
  };
  const auto turns = [](double x) {
    return x - static_cast<double>(kTwoPiF) * std::round(x / static_cast<double>(kTwoPiF));
  };
  double at = shown(0);  // unwrapped phase shown
  std::vector<double> unwrapped{at};
  for (std::size_t i = 1; i <= kFine; ++i) {
    const double step = turns(shown(i) - at);
    usable_ = usable_ && step > 0;
    at += step;
    unwrapped.push_back(at);
  }
  if (!usable_) return;
  const double fine_step = static_cast<double>(kTwoPiF) / kFine, turn = static_cast<double>(kTwoPiF);
  for (std::size_t j = 0; j <= kPhases; ++j) {
    double wanted = -static_cast<double>(kPiF) + turn * static_cast<double>(j) / kPhases;
    wanted += turn * std::ceil((unwrapped.front() - wanted) / turn);
    const auto next = std::upper_bound(unwrapped.begin(), unwrapped.end(), wanted);
    const std::size_t i = std::min<std::size_t>(kFine, static_cast<std::size_t>(next - unwrapped.begin())) - 1;
    const double width = unwrapped[i + 1] - unwrapped[i], part = (wanted - unwrapped[i]) / width;
    const std::size_t k = (i + 1) % kFine;
    const double c = seen.cosine[i] + part * (seen.cosine[k] - seen.cosine[i]);
    const double s = seen.sine[i] + part * (seen.sine[k] - seen.sine[i]);
    const double mean = seen.mean[i] + part * (seen.mean[k] - seen.mean[i]), length = std::sqrt(c * c + s * s);
    by_phase_[j] = {static_cast<float>(turns(fine_step * (static_cast<double>(i) + part) - wanted)),
                    static_cast<float>(1 / length), static_cast<float>(-mean / length),
                    static_cast<float>(fine_step / width)};
    usable_ = usable_ && width > kLeastSlope * fine_step;
  }
}

void Lineariser::tabulate_level(const Waveform& wave) {
  double lowest = wave.at(-1).value, highest = wave.at(1).value;
  lowest_ = static_cast<float>(lowest - kBeyond);
  per_level_ = static_cast<float>(kLevels / (highest - lowest + 2 * kBeyond));
  double c = -1;
  for (std::size_t j = 0; j <= kLevels; ++j) {
    const double level = static_cast<double>(lowest_) + static_cast<double>(j) / static_cast<double>(per_level_);
    // Upwards from the level before; beyond the wave's own levels the slope at its end goes on.
    while (c < 1 && wave.at(c).value < level) c += 1.0 / kFine;
    const double at = std::clamp(c, -1.0, 1.0);
    const auto [value, slope] = wave.at(at);
    const bool flat = slope < kLeastSlope;
    by_level_.push_back(flat ? std::numeric_limits<float>::quiet_NaN()
                             : static_cast<float>(at + (level - value) / slope));
  }
}

Lineariser::Entry Lineariser::entry(float phase_rad) const noexcept {
  const float x = (phase_rad + kPiF) * (static_cast<float>(kPhases) / kTwoPiF);
  const auto j = std::min<std::size_t>(kPhases - 1, static_cast<std::size_t>(std::max(0.0F, x)));
  const float part = x - static_cast<float>(j);
  const Entry &a = by_phase_[j], &b = by_phase_[j + 1];
  return {a.turn_rad + part * (b.turn_rad - a.turn_rad), a.scale + part * (b.scale - a.scale),
          a.mean + part * (b.mean - a.mean), a.slope + part * (b.slope - a.slope)};
}

float Lineariser::cosine_of(float level) const noexcept {
  const float x = (level - lowest_) * per_level_;
  if (!(x >= 0) || x >= static_cast<float>(kLevels)) return std::numeric_limits<float>::quiet_NaN();
  const auto j = static_cast<std::size_t>(x);
  const float part = x - static_cast<float>(j);
  return by_level_[j] + part * (by_level_[j + 1] - by_level_[j]);
}

void Lineariser::apply(const PhaseConfig& config, PhaseMaps& maps) const {
  for (std::size_t i = 0; i < maps.phase_rad.size(); ++i) {
    PixelReject& reject = maps.reject[i];
    if (reject != PixelReject::kNone && reject != PixelReject::kNoisy) continue;
    const Entry e = entry(maps.phase_rad[i]);
    const float shown = maps.modulation_dn[i], b = shown * e.scale, lift = shown * e.mean;
    float phi = maps.phase_rad[i] + e.turn_rad;
    phi -= phi >= kPiF ? kTwoPiF : (phi < -kPiF ? -kTwoPiF : 0);
    const float half_cos = cos_poly(0.5F * phi), half_sin = sin_poly(0.5F * phi);
    maps.phase_rad[i] = phi;
    maps.mean_dn[i] += lift;
    maps.modulation_dn[i] = b;
    maps.cosine_dn[i] = b * (1 - 2 * half_sin * half_sin);
    maps.sine_dn[i] = b * 2 * half_sin * half_cos;
    maps.code_dn[i] = b * cosine_of((maps.code_dn[i] - lift) / b);
    maps.sigma_rad[i] *= e.slope;
    reject = maps.sigma_rad[i] < config.max_sigma_rad ? PixelReject::kNone : PixelReject::kNoisy;
  }
}

Waveform linearise(const ThreeStep& frames, int fringe_px, const WaveFitConfig& fit, const PhaseConfig& config,
                   PhaseMaps& maps) {
  const Waveform wave = fit_waveform(wave_moments(maps, frames, fringe_px, fit.row_step), frames, fit);
  if (!(wave.strength() > 0)) return {};
  const Lineariser lineariser(wave, frames);
  if (!lineariser.usable()) return {};
  lineariser.apply(config, maps);
  return wave;
}

}  // namespace enamel::pipeline
