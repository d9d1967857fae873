#include "pipeline/decode/phase/wave_knowledge.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace enamel::pipeline {
namespace {

constexpr int kPhases = 720;      // layout: of the fringe, for the harmonics of a response
constexpr double kMedian = 1.57;  // derived: variance of a median over that of a mean, of a Gaussian: pi/2

double median_of(std::span<double> values) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

/// Emission of a level, straight lines between the measured ones.
double emission_of(const calib::ProjectorResponse& r, double level) {
  const auto above = std::upper_bound(r.level.begin() + 1, r.level.end() - 1, level) - r.level.begin();
  const auto high = static_cast<std::size_t>(above), low = high - 1;
  const double share = (level - r.level[low]) / (r.level[high] - r.level[low]);
  return r.emission[low] + std::clamp(share, 0.0, 1.0) * (r.emission[high] - r.emission[low]);
}

bool shows_cosine(const WaveKnowledge& known, const WaveFitConfig& config) {
  return static_cast<double>(known.bursts) >= config.sure_bursts && known.median().strength() < config.least_learned;
}

}  // namespace

Waveform WaveKnowledge::median() const {
  Waveform out;
  std::array<double, kWavesLearned> values{};
  for (std::size_t n = 0; n < kWaveHarmonics; ++n) {
    for (std::size_t k = 0; k < bursts; ++k) values[k] = shown[k].harmonic[n];
    out.harmonic[n] = median_of(std::span(values).first(bursts));
  }
  return out;
}

void learn(const Waveform& shown, WaveKnowledge& known) {
  if (!known.is_complete()) known.shown[known.bursts++] = shown;
}

Waveform uncorrected_wave(const calib::ProjectorResponse& response, const calib::PatternValues& patterns) {
  std::array<double, kWaveHarmonics + 2> amplitude{};
  for (int i = 0; i < kPhases; ++i) {
    const double phi = 2 * std::numbers::pi * i / kPhases;
    const double emission = emission_of(response, patterns.mean + patterns.amplitude * std::cos(phi));
    for (std::size_t n = 1; n < amplitude.size(); ++n)
      amplitude[n] += emission * std::cos(static_cast<double>(n) * phi);
  }
  Waveform out;
  if (!(amplitude[1] > 0)) return out;
  for (std::size_t n = 0; n < kWaveHarmonics; ++n) out.harmonic[n] = amplitude[n + 2] / amplitude[1];
  return out;
}

std::vector<WavePrior> priors_of(const calib::Rig& rig, const WaveFitConfig& config) {
  std::vector<WavePrior> out{{{}, config.prior, config.least_strength}};
  if (!rig.response || !calib::is_rising(*rig.response)) return out;
  WavePrior stated{uncorrected_wave(*rig.response, rig.patterns), {}, config.least_strength};
  for (std::size_t n = 0; n < kWaveHarmonics; ++n) {
    // Blur has taken an unknown part, the more of the higher ones: from none of it to most.
    const double left = 1 / (1 + config.blur_taken * static_cast<double>((n + 2) * (n + 2) - 1));
    const double sharp = stated.mean.harmonic[n];
    stated.mean.harmonic[n] = 0.5 * (1 + left) * sharp;
    stated.sigma[n] = std::max(0.5 * (1 - left) * std::abs(sharp), config.prior.back());
  }
  out.push_back(stated);
  return out;
}

std::vector<WavePrior> priors_after(const WaveKnowledge& known, const std::vector<WavePrior>& before,
                                    const WaveFitConfig& config) {
  if (known.bursts == 0) return before;
  if (shows_cosine(known, config)) return {};
  const Waveform learned = known.median();
  const auto bursts = static_cast<double>(known.bursts);
  const bool sure = bursts >= config.sure_bursts;
  // Near the limit bursts of one scan are treated alike.
  WavePrior next{{}, config.prior, sure ? 0.5 * config.least_learned : config.least_strength};
  for (std::size_t n = 0; n < config.learned_spread.size(); ++n) {
    const double defocus = config.defocus_share[n] * learned.harmonic[n], spread = config.learned_spread[n];
    const double precision = 1 / (defocus * defocus + spread * spread * kMedian / bursts);
    const double in_all = precision + 1 / (config.prior[n] * config.prior[n]);
    next.mean.harmonic[n] = precision * learned.harmonic[n] / in_all;
    next.sigma[n] = 1 / std::sqrt(in_all);
  }
  return {next};
}

bool is_settled(const WaveKnowledge& known, const WaveFitConfig& config) {
  return known.is_complete() || shows_cosine(known, config);
}

}  // namespace enamel::pipeline
