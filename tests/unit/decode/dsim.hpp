// What the tests share that re-create the design's simulations (docs/notes/design-figures.md): signals without optics.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "pipeline/decode/mode_t/polarity.hpp"
#include "tests/unit/decode/folder_burst.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::test::dsim {

inline constexpr double kPi = std::numbers::pi;

inline double wrap(double a) { return std::remainder(a, 2 * kPi); }

/// Phases that cover a fringe evenly, none of them on a multiple of pi/4.
inline std::vector<double> even_phases(int n) {
  std::vector<double> out;
  out.reserve(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) out.push_back(-kPi + 2 * kPi * (i + 0.5) / n);
  return out;
}

/// About the mean: a constant phase bends no surface.
inline double rms(const std::vector<double>& errors) {
  double sum = 0, squares = 0;
  for (const double e : errors) sum += e, squares += e * e;
  const auto n = static_cast<double>(errors.size());
  return std::sqrt(std::max(0.0, squares / n - sum * sum / (n * n)));
}

/// Light of a projector with this gamma at full contrast, 0 … 1.
struct Gamma {
  double gamma = 1;
  double operator()(double phi) const { return std::pow(0.5 + 0.5 * std::cos(phi), gamma); }
};

/// N-step phase of a waveform, shifts 2 pi k/N, the whole pattern shifted by `start`.
template <class Wave>
double n_step(const Wave& wave, int n, double phi, double start = 0) {
  double s = 0, c = 0;
  for (int k = 0; k < n; ++k) {
    const double delta = 2 * kPi * k / n, light = wave(phi + start + delta);
    s -= light * std::sin(delta), c += light * std::cos(delta);
  }
  return std::atan2(s, c) - start;
}

inline constexpr double kMean_dn = 30000, kModulation_dn = 20000;  ///< of 16 bit: rounding is 1.5e-5 of the modulation

/// 16-bit frames from a wave(frame, pixel) in units of the modulation.
template <class Wave>
FrameSet frames16(int width, int height, const Wave& wave) {
  FrameSet out{width, height, {}, 16};
  for (std::size_t k = 0; k < 4; ++k) {
    for (int i = 0; i < width * height; ++i) {
      const auto dn = static_cast<std::uint16_t>(std::lround(kMean_dn + kModulation_dn * wave(static_cast<int>(k), i)));
      out.frames[k].push_back(static_cast<std::uint8_t>(dn & 255U));
      out.frames[k].push_back(static_cast<std::uint8_t>(dn >> 8U));
    }
  }
  return out;
}

/// The noise model of such frames; noise in units of the modulation.
inline pipeline::NoiseModel noise16(double noise) {
  pipeline::NoiseModel model;
  model.floor_dn2 = static_cast<float>(std::pow(kModulation_dn * noise, 2) + 1.0 / 12);
  model.full_scale_dn = 65535;
  return model;
}

/// Three-frame solution, then the fourth frame with b = +1 everywhere.
inline void solve_four(const FrameSet& frames, double noise, pipeline::PhaseMaps& maps,
                       pipeline::PolarityMaps& polarity) {
  pipeline::compute_phase(frames.view(), noise16(noise), {}, maps);
  std::vector<pipeline::CellSpan> rows;
  rows.reserve(static_cast<std::size_t>(frames.height));
  for (int v = 0; v < frames.height; ++v) rows.push_back({v, 0, frames.width, 0, false});
  pipeline::apply_polarity(rows, {std::vector<float>(8, 1.0F), false}, noise16(noise), {}, maps, polarity);
}

}  // namespace enamel::test::dsim
