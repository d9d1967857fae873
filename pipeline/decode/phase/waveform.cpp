#include "pipeline/decode/phase/waveform.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace enamel::pipeline {
namespace {

constexpr double kHalfRootThree = 0.86602540378443865;  // physical: sin 60 degrees

/// cos n phi, n = 1 … kWaveHarmonics + 1, from cos phi.
std::array<double, kWaveHarmonics + 1> multiples(double c) {
  std::array<double, kWaveHarmonics + 1> t{c, 2 * c * c - 1};
  for (std::size_t n = 2; n < t.size(); ++n) t[n] = 2 * c * t[n - 1] - t[n - 2];
  return t;
}

}  // namespace

Waveform::Level Waveform::at(double c) const noexcept {
  const auto t = multiples(c);
  std::array<double, kWaveHarmonics + 1> u{1, 2 * c};  // T_n' = n U_(n-1)
  for (std::size_t n = 2; n < u.size(); ++n) u[n] = 2 * c * u[n - 1] - u[n - 2];
  Level out{c, 1};
  for (std::size_t k = 0; k < kWaveHarmonics; ++k) {
    out.value += harmonic[k] * t[k + 1];
    out.slope += harmonic[k] * static_cast<double>(k + 2) * u[k + 1];
  }
  return out;
}

double Waveform::strength() const noexcept {
  double most = 2 * std::abs(harmonic[0]);
  for (const double h : harmonic) most = std::max(most, std::abs(h));
  return most / 2;
}

const FrameScheme& micro_three_step() {
  static const FrameScheme frames{{1, -0.5, -0.5, 0},
                                  {0, kHalfRootThree, -kHalfRootThree, 0},
                                  {1.0 / 3, 1.0 / 3, 1.0 / 3, 0},
                                  {2.0 / 3, -1.0 / 3, -1.0 / 3, 0},
                                  {0, -0.5 / kHalfRootThree, 0.5 / kHalfRootThree, 0},
                                  {{3, false}, {6, false}}};
  return frames;
}

const FrameScheme& four_step_three() {
  static const FrameScheme frames{{1, 0, -1, 0},     {0, 1, 0, -1},     {0.5, 0, 0.5, 0},
                                  {0.5, 0, -0.5, 0}, {0.5, -1, 0.5, 0}, {{1, true}, {3, true}, {4, false}, {5, true}}};
  return frames;
}

const FrameScheme& four_step_four() {
  static const FrameScheme frames{{1, 0, -1, 0},     {0, 1, 0, -1},     {0.5, 0, 0.5, 0},
                                  {0.5, 0, -0.5, 0}, {0, -0.5, 0, 0.5}, {}};
  return frames;
}

SeenWave see(const Waveform& wave, const FrameScheme& frames, std::size_t points) {
  SeenWave out;
  for (auto* values : {&out.mean, &out.cosine, &out.sine}) values->reserve(points);
  // Turned on step by step: products and sums only, the same bits everywhere.
  const double step = 2 * std::numbers::pi / static_cast<double>(points);
  const double half_step = step / 2, half_sine = half_step - half_step * half_step * half_step / 6 +
                                                 std::pow(half_step, 5) / 120 - std::pow(half_step, 7) / 5040;
  const double turn_cos = 1 - 2 * half_sine * half_sine;
  const double turn_sin = 2 * half_sine * std::sqrt(1 - half_sine * half_sine);
  double c = 1, s = 0;
  for (std::size_t i = 0; i < points; ++i) {
    double mean = 0, cosine = 0, sine = 0;
    for (std::size_t k = 0; k < frames.mean.size(); ++k) {
      const double level = wave.at(c * frames.shift_cos[k] - s * frames.shift_sin[k]).value;
      mean += frames.mean[k] * level, cosine += frames.cosine[k] * level, sine += frames.sine[k] * level;
    }
    out.mean.push_back(mean), out.cosine.push_back(cosine), out.sine.push_back(sine);
    const double turned = c * turn_cos - s * turn_sin;
    s = s * turn_cos + c * turn_sin, c = turned;
  }
  return out;
}

}  // namespace enamel::pipeline
