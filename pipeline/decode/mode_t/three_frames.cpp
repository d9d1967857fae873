#include "pipeline/decode/mode_t/three_frames.hpp"

namespace enamel::pipeline {
namespace {

/// A, C and S as weights of the frames, by the frame that is missing.
struct Weights {
  Frames mean, cosine, sine;
};
/// derived: the equations of the three frames that are left, solved.
constexpr std::array<Weights, 4> kWithout = {{{{0, 0.5F, 0, 0.5F}, {0, 0.5F, -1, 0.5F}, {0, -0.5F, 0, 0.5F}},
                                              {{0.5F, 0, 0.5F, 0}, {0.5F, 0, -0.5F, 0}, {-0.5F, 0, -0.5F, 1}},
                                              {{0, 0.5F, 0, 0.5F}, {1, -0.5F, 0, -0.5F}, {0, -0.5F, 0, 0.5F}},
                                              {{0.5F, 0, 0.5F, 0}, {0.5F, 0, -0.5F, 0}, {0.5F, -1, 0.5F, 0}}}};
/// layout: the frames that are left.
constexpr std::array<std::array<std::size_t, 3>, 4> kOthers = {{{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}}};

float dot(const Frames& w, const Frames& x) { return w[0] * x[0] + w[1] * x[1] + w[2] * x[2] + w[3] * x[3]; }

/// A frame is A + cosine C + sine S.
struct Wave {
  float cosine, sine;
};
using Waves = std::array<Wave, 4>;

Waves waves_of(const Turns& t) {
  return {{{t.a0.cos, -t.a0.sin}, {-t.a1.sin, -t.a1.cos}, {-t.a2.cos, t.a2.sin}, {t.a3.sin, t.a3.cos}}};
}

FourStepPixel solve(std::size_t missing, const Waves& waves, const Frames& x) {
  const auto& others = kOthers[missing];
  const Wave& first = waves[others[0]];
  const auto beyond = [&](std::size_t n) {
    return Wave{waves[others[n]].cosine - first.cosine, waves[others[n]].sine - first.sine};
  };
  const Wave p = beyond(1), q = beyond(2);
  const float a = x[others[0]], y = x[others[1]] - a, z = x[others[2]] - a;
  const float inverse = 1 / (p.cosine * q.sine - p.sine * q.cosine);
  const float cosine = (y * q.sine - p.sine * z) * inverse, sine = (p.cosine * z - y * q.cosine) * inverse;
  return {a - first.cosine * cosine - first.sine * sine, cosine, sine};
}

/// B cos of twice a frame's phase.
float harmonic_of(const FourStepPixel& at, const Wave& wave) {
  const float b = root(at.cosine * at.cosine + at.sine * at.sine + 1e-6F);
  const float in_phase = wave.cosine * at.cosine + wave.sine * at.sine;
  return 2 * in_phase * in_phase / b - b;
}

}  // namespace

FourStepPixel solve_without(std::size_t missing, const Frames& x) noexcept {
  const Weights& w = kWithout[missing];
  return {dot(w.mean, x), dot(w.cosine, x), dot(w.sine, x)};
}

FourStepPixel solve_without(std::size_t missing, const Frames& x, const PixelChange& change, float harmonic) noexcept {
  const Waves waves = waves_of(turns_of<false>(change));
  Frames plain{};
  for (std::size_t k = 0; k < x.size(); ++k) plain[k] = x[k] / change.light(static_cast<float>(k) - 1.5F);
  const FourStepPixel with = solve(missing, waves, plain);
  for (std::size_t k = 0; k < x.size(); ++k) plain[k] -= harmonic * harmonic_of(with, waves[k]);
  return solve(missing, waves, plain);
}

float sigma_without(std::size_t missing, const FourStepPixel& pixel, const Frames& x,
                    const NoiseModel& noise) noexcept {
  const Weights& w = kWithout[missing];
  const float c = pixel.cosine, s = pixel.sine;
  float variance_b4 = 1e-12F;  // as in frame_rows.hpp
  for (std::size_t k = 0; k < x.size(); ++k) {
    const float by_frame = c * w.sine[k] - s * w.cosine[k];
    variance_b4 += by_frame * by_frame * noise.variance(x[k] + noise.black_dn);
  }
  return root(variance_b4) / (c * c + s * s + 1e-6F);
}

}  // namespace enamel::pipeline
