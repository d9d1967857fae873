// What a projector whose grey response is not linear makes of a cosine, and what three phase-shifted frames of it show
// (docs/decode.md §6). The response acts on each level by itself and blur is symmetric, so the wave is even:
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
  /// Largest of |h_n|.
  [[nodiscard]] double strength() const noexcept;
};

/// Three frames A + B w(phi + shift_k) and how they are solved as if w were a cosine: weights of the frames in A,
/// C = B cos phi and S = B sin phi.
struct ThreeStep {
  std::array<double, 3> shift_cos{}, shift_sin{};
  std::array<double, 3> mean{}, cosine{}, sine{};
  /// Parts of the wave's distortion by which it is recognised: cos or sin of `times` phi. What motion and slanted
  /// surfaces do looks otherwise.
  struct Fold {
    int times = 0;
    bool sine = false;
  };
  std::vector<Fold> folds;
};

/// Frames 0, 2, 3 of mode M; frames 0, 1, 2 of mode T.
[[nodiscard]] const ThreeStep& micro_three_step();
[[nodiscard]] const ThreeStep& four_step_three();

/// What the three frames of a unit wave look like when solved as cosines, at phases evenly spread over the fringe.
struct SeenWave {
  std::vector<double> phase_rad;           ///< true phase, 0 … 2 pi
  std::vector<double> mean, cosine, sine;  ///< A - A_true, C, S over B_true
};
[[nodiscard]] SeenWave see(const Waveform& wave, const ThreeStep& frames, std::size_t points);

}  // namespace enamel::pipeline
