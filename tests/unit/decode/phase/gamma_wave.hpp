// What a projector of one gamma makes of a cosine, computed by the textbook and not by the decoder.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "pipeline/decode/mode_m/micro_phase.hpp"
#include "pipeline/decode/phase/phase.hpp"
#include "pipeline/decode/phase/waveform.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::test {

/// ((1 + cos phi)/2)^gamma, 0 … 1.
inline double gamma_light(double gamma, double phi) {
  return std::pow(std::max(0.0, 0.5 + 0.5 * std::cos(phi)), gamma);
}

/// h_2 … h_5 of it, by sums over the fringe.
inline pipeline::Waveform gamma_wave(double gamma) {
  constexpr int kPoints = 20000;
  std::array<double, pipeline::kWaveHarmonics + 1> sums{};
  for (int i = 0; i < kPoints; ++i) {
    const double phi = 2 * std::numbers::pi * i / kPoints;
    for (std::size_t n = 0; n < sums.size(); ++n)
      sums[n] += gamma_light(gamma, phi) * std::cos(static_cast<double>(n + 1) * phi);
  }
  pipeline::Waveform out;
  for (std::size_t n = 0; n < out.harmonic.size(); ++n) out.harmonic[n] = sums[n + 1] / sums[0];
  return out;
}

/// cos phi + sum_n h_n cos n phi.
inline double wave_at(const pipeline::Waveform& wave, double phi) {
  double sum = std::cos(phi);
  for (std::size_t n = 0; n < wave.harmonic.size(); ++n)
    sum += wave.harmonic[n] * std::cos(static_cast<double>(n + 2) * phi);
  return sum;
}

inline double turned(double rad) { return std::remainder(rad, 2 * std::numbers::pi); }

/// What three frames of a unit wave say of a phase: C + iS, by the textbook. Mode M: at thirds of a fringe; mode T: at
/// 0, 1/4, 1/2.
inline std::complex<double> three_frames_say(const pipeline::Waveform& wave, bool thirds, double phi) {
  const double step = thirds ? 2 * std::numbers::pi / 3 : std::numbers::pi / 2;
  const double a = wave_at(wave, phi), b = wave_at(wave, phi + step), c = wave_at(wave, phi + 2 * step);
  if (thirds) return {(2 * a - b - c) / 3, (c - b) / std::sqrt(3.0)};
  return {(a - c) / 2, (a + c) / 2 - b};
}

/// Pixel i of noiseless frames of B = 50 about 100 DN. said: three_frames_say; mean, code: of the unit wave.
inline void put_unit_wave(std::size_t i, std::complex<double> said, double mean, double code,
                          pipeline::PhaseMaps& maps) {
  maps.mean_dn[i] = static_cast<float>(100 + 50 * mean);
  maps.cosine_dn[i] = static_cast<float>(50 * said.real()), maps.sine_dn[i] = static_cast<float>(50 * said.imag());
  maps.code_dn[i] = static_cast<float>(50 * (code - mean));
  maps.modulation_dn[i] = static_cast<float>(50 * std::abs(said));
  maps.phase_rad[i] = static_cast<float>(std::arg(said));
  maps.reject[i] = pipeline::PixelReject::kNone;
}

/// A burst of fringes along rows. Texture of 20 %, twice as bright at one end of the row as at the other, sensor noise.
struct FringesOnTexture {
  int width = 640, height = 160;
  double gamma = 1, fringe_px = 24.3, motion_rad = 0;
  double white_dn = 130, pedestal_dn = 12;  ///< above black, of the brightest

  [[nodiscard]] double phase(int u, int v) const { return 2 * std::numbers::pi * (u / fringe_px + 0.0737 * v); }
  [[nodiscard]] double reflects(int u, int v) const {
    const double texture = 0.1 * std::sin(u / 11.0 + v / 5.0) + 0.1 * std::sin(u / 31.0 - v / 7.0);
    return (1 + texture) * (1 + static_cast<double>(u) / width) / 2;
  }

  /// Solved by the decoder as if the projector were linear.
  [[nodiscard]] pipeline::PhaseMaps solved(bool thirds) const {
    const calib::NoiseValues sensor = *cropped_rig(8, 8).noise;
    FrameSet set{width, height, {}};
    Normals normal(5);
    for (std::size_t k = 0; k < 4; ++k) {
      const double step = thirds ? 2 * std::numbers::pi / 3 : std::numbers::pi / 2;
      const double shift = step * (thirds ? (k == 0 ? 0.0 : static_cast<double>(k) - 1) : static_cast<double>(k));
      for (int i = 0; i < width * height; ++i) {
        const double phi = phase(i % width, i / width) + shift + motion_rad * (static_cast<double>(k) - 1.5);
        const double dn = reflects(i % width, i / width) * (pedestal_dn + white_dn * gamma_light(gamma, phi));
        const double sigma_dn =
            std::sqrt(dn * sensor.gain_e_per_dn + sensor.read_noise_e * sensor.read_noise_e) / sensor.gain_e_per_dn;
        set.frames[k].push_back(static_cast<std::uint8_t>(std::lround(sensor.black_dn + dn + sigma_dn * normal())));
      }
    }
    pipeline::PhaseMaps maps;
    const pipeline::NoiseModel noise = pipeline::noise_from_rig(sensor, 8);
    if (thirds) {
      pipeline::compute_micro_phase(set.view(), noise, {}, maps);
    } else {
      pipeline::compute_phase(set.view(), noise, {}, maps);
    }
    return maps;
  }
};

}  // namespace enamel::test
