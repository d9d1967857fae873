#include "pipeline/decode/phase/wave_tables.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pipeline/decode/phase/chosen.hpp"

namespace enamel::pipeline {
namespace {

constexpr std::size_t kFine = 4096, kLevels = 1024, kWidths = 512;  // layout: linear between; errors below 1e-4 rad
constexpr double kTurn = 6.283185307179586;                         // physical: 2 pi
constexpr double kUniform = 0.57735;  // derived: sigma of a uniform distribution over its half width, 1/sqrt 3

double wrapped(double x) { return x - kTurn * std::round(x / kTurn); }

/// The phase shown along three fringes, unwrapped.
std::vector<double> shown_along(const SeenWave& seen) {
  std::vector<double> out;
  for (std::size_t i = 0; i <= 3 * kFine; ++i) {
    const std::size_t k = i % kFine;
    const auto phase =
        static_cast<double>(atan2_poly(static_cast<float>(seen.sine[k]), static_cast<float>(seen.cosine[k])));
    out.push_back(out.empty() ? phase - kTurn : out.back() + wrapped(phase - out.back()));
  }
  return out;
}

/// Where a rising sequence passes a value, in steps.
double place_in(const std::vector<double>& rising, double value) {
  const auto next = std::upper_bound(rising.begin(), rising.end(), value);
  const auto i = static_cast<std::size_t>(next - rising.begin());
  if (i == 0 || i == rising.size()) return static_cast<double>(i);
  return static_cast<double>(i - 1) + (value - rising[i - 1]) / (rising[i] - rising[i - 1]);
}

/// Where the phase shown passes a value for the first and for the last time.
class Crossings {
 public:
  explicit Crossings(std::vector<double> shown) : first_(shown), last_(std::move(shown)) {
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] = std::max(first_[i], first_[i - 1]);
    for (std::size_t i = last_.size() - 1; i > 0; --i) last_[i - 1] = std::min(last_[i - 1], last_[i]);
  }
  [[nodiscard]] std::pair<double, double> at(double shown_rad) const {
    return {place_in(first_, shown_rad), place_in(last_, shown_rad)};
  }

 private:
  std::vector<double> first_, last_;  ///< largest so far, least from here on
};

double between(const std::vector<double>& ring, double place) {
  const double whole = std::floor(place), part = place - whole;
  const std::size_t i = static_cast<std::size_t>(whole) % kFine;
  return ring[i] + part * (ring[(i + 1) % kFine] - ring[i]);
}

}  // namespace

PhaseTable::PhaseTable(const Waveform& wave, const FrameScheme& frames) {
  const SeenWave seen = see(wave, frames, kFine);
  const Crossings crossings(shown_along(seen));
  constexpr double kStep = kTurn / kFine;
  for (std::size_t j = 0; j <= kPhases; ++j) {
    const double shown = -kTurn / 2 + kTurn * static_cast<double>(j) / kPhases, reach = kTurn / kPhases;
    const auto [first, last] = crossings.at(shown);
    const double place = 0.5 * (first + last);
    const double c = between(seen.cosine, place), s = between(seen.sine, place), length = std::sqrt(c * c + s * s);
    const auto [low, low_last] = crossings.at(shown - reach);
    const auto [high, high_last] = crossings.at(shown + reach);
    const double slope = 0.5 * (high + high_last - low - low_last) * kStep / (2 * reach);
    entries_.push_back({static_cast<float>(wrapped(kStep * place - shown)), static_cast<float>(1 / length),
                        static_cast<float>(-between(seen.mean, place) / length),
                        static_cast<float>(std::min(slope, kLargestWaveSlope)),
                        static_cast<float>(0.5 * (last - first) * kStep * kUniform)});
  }
}

WaveWidening::WaveWidening(const Waveform& wave, const FrameScheme& frames) {
  const PhaseTable table(wave, frames);
  const SeenWave seen = see(wave, frames, kWidths);
  for (std::size_t i = 0; i < kWidths; ++i) {
    const float shown = atan2_poly(static_cast<float>(seen.sine[i]), static_cast<float>(seen.cosine[i]));
    const PhaseTable::Entry e = table.at(shown);
    entries_.push_back({e.slope * e.scale, e.spread_rad});
  }
}

WaveWidening::Entry WaveWidening::at(float phase_rad) const noexcept {
  const float place = (phase_rad < 0 ? phase_rad + kTwoPiF : phase_rad) * (static_cast<float>(kWidths) / kTwoPiF);
  return entries_[static_cast<std::size_t>(place) % kWidths];
}

LevelTable::LevelTable(const Waveform& wave) {
  const double lowest = wave.at(-1).value - kBeyondWave, highest = wave.at(1).value + kBeyondWave;
  lowest_ = static_cast<float>(lowest), per_level_ = static_cast<float>(kLevels / (highest - lowest));
  double c = -1;
  for (std::size_t j = 0; j <= kLevels; ++j) {
    const double level = lowest + static_cast<double>(j) * (highest - lowest) / kLevels;
    // Upwards from the level before; beyond the wave's own levels the slope at its end goes on.
    while (c < 1 && wave.at(c).value < level) c += 1.0 / kFine;
    const double at = std::clamp(c, -1.0, 1.0);
    const auto [value, slope] = wave.at(at);
    const bool flat = slope * kLargestWaveSlope < 1;
    cosine_.push_back(flat ? std::numeric_limits<float>::quiet_NaN()
                           : static_cast<float>(at + (level - value) / slope));
  }
}

float LevelTable::cosine_of(float level) const noexcept {
  const float x = (level - lowest_) * per_level_;
  if (!(x >= 0) || x >= static_cast<float>(kLevels)) return std::numeric_limits<float>::quiet_NaN();
  const auto j = static_cast<std::size_t>(x);
  const float part = x - static_cast<float>(j);
  return cosine_[j] + part * (cosine_[j + 1] - cosine_[j]);
}

}  // namespace enamel::pipeline
