// What a projector whose grey response is not linear makes of a cosine, and what three phase-shifted frames of it show
// (docs/waveform.md). The response acts on each level by itself and blur is symmetric, so the wave is even:
//   w(phi) = cos phi + sum_n h_n cos n phi = F(cos phi),   F(c) = c + sum_n h_n T_n(c),   n = 2 … 5
// with the Chebyshev polynomials T_n. Harmonics of a gamma: Liu et al. 2010.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace enamel::pipeline {

inline constexpr std::size_t kWaveHarmonics = 4;  ///< layout: n = 2 … 5; blur leaves no more

struct Waveform {
  std::array<double, kWaveHarmonics> harmonic{};  ///< h_n = B_n/B_1

  /// F and its derivative at c = cos phi.
  struct Level {
    double value = 0, slope = 1;
  };
  [[nodiscard]] Level at(double c) const noexcept;
  /// |h_2|, or half of another one: they leave the phase of three frames alone to first order.
  [[nodiscard]] double strength() const noexcept;
  [[nodiscard]] bool is_cosine() const noexcept { return !(strength() > 0); }
  bool operator==(const Waveform&) const = default;
};

/// sum_n h_n cos n a from cos a, n >= 2: what the wave has beyond its cosine. For loops over pixels.
struct WaveValues {
  std::array<float, kWaveHarmonics> h;

  explicit WaveValues(const Waveform& wave) {
    for (std::size_t n = 0; n < h.size(); ++n) h[n] = static_cast<float>(wave.harmonic[n]);
  }
  [[nodiscard, gnu::always_inline]] float at(float c) const noexcept {
    const float c2 = 2 * c * c - 1, c3 = c * (2 * c2 - 1), c4 = 2 * c2 * c2 - 1, c5 = 2 * c * c4 - c3;
    return h[0] * c2 + h[1] * c3 + h[2] * c4 + h[3] * c5;
  }
};

/// Frames A + B w(phi + shift_k) and how they are solved as if w were a cosine: weights of the frames in A,
/// C = B cos phi and S = B sin phi. Frames without any weight are not read.
struct FrameScheme {
  std::array<double, 4> shift_cos{}, shift_sin{};
  std::array<double, 4> mean{}, cosine{}, sine{};
  /// Parts of the wave's distortion by which it is recognised: cos or sin of `times` phi. What motion and slanted
  /// surfaces do looks otherwise.
  struct Fold {
    int times = 0;
    bool sine = false;
  };
  std::vector<Fold> folds;
};

/// Frames 0, 2, 3 of mode M.
[[nodiscard]] const FrameScheme& micro_three_step();
/// Frames 0, 1, 2 of mode T; all of them where the sign of frame 3 is plus.
[[nodiscard]] const FrameScheme& four_step_three();
[[nodiscard]] const FrameScheme& four_step_four();

/// What the frames of a unit wave look like when solved as cosines, at phases evenly spread over the fringe from 0 on.
struct SeenWave {
  std::vector<double> mean, cosine, sine;  ///< A - A_true, C, S over B_true
};
[[nodiscard]] SeenWave see(const Waveform& wave, const FrameScheme& frames, std::size_t points);

}  // namespace enamel::pipeline
