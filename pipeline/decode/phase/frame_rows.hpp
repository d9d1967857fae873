// What all modes share on the way from frames to phase: rows as floats, the physical mask, and the solution of a burst
// whose phase rests on three of the frames while the fourth carries the code. Private to pipeline/decode.
#pragma once

#include <array>
#include <cstring>
#include <limits>
#include <vector>

#include "pipeline/decode/phase/phase.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"

namespace enamel::pipeline {

using FrameRows = std::array<std::vector<float>, 4>;

/// Row `row` of all frames; for the instruction set of whoever calls.
[[gnu::always_inline]] inline void load_row(const BurstView& view, std::size_t row, FrameRows& rows) {
  const auto width = static_cast<std::size_t>(view.width);
  for (std::size_t k = 0; k < 4; ++k) {
    float* __restrict out = rows[k].data();
    if (view.bit_depth == 8) {
      const std::uint8_t* __restrict in = view.frames[k].data() + row * width;
      for (std::size_t u = 0; u < width; ++u) out[u] = in[u];
    } else {
      const std::uint8_t* __restrict in = view.frames[k].data() + 2 * row * width;
      for (std::size_t u = 0; u < width; ++u) {
        std::uint16_t value = 0;
        std::memcpy(&value, in + 2 * u, 2);
        out[u] = value;
      }
    }
  }
}

/// The three frames that the phase rests on: a, b, c, in any order.
struct MaskFrames {
  const float* a;
  const float* b;
  const float* c;
};

/// kDark, kSaturated, kNoisy or kNone of every pixel of a row, from its phase frames and the sigma of its phase.
[[gnu::always_inline]] inline void mask_row(const MaskFrames& frames, std::size_t width, const NoiseModel& noise,
                                            const PhaseConfig& config, const float* sigma_rad, PixelReject* out) {
  constexpr auto kNone = static_cast<int>(PixelReject::kNone), kNoisy = static_cast<int>(PixelReject::kNoisy);
  constexpr auto kDark = static_cast<int>(PixelReject::kDark), kFull = static_cast<int>(PixelReject::kSaturated);
  const float* __restrict a = frames.a, * __restrict b = frames.b, * __restrict c = frames.c;
  const float* __restrict sigma = sigma_rad;
  PixelReject* __restrict reject = out;
  const float saturated_dn = config.saturation * noise.full_scale_dn, max_sigma = config.max_sigma_rad;
  const float clip_dn = noise.black_dn > 0 ? 0.5F : -1.0F;  // a pedestal exists so that dark pixels are not clipped
  const float dark_dn = noise.black_dn + config.dark_sigmas * root(noise.floor_dn2);
  for (std::size_t u = 0; u < width; ++u) {
    const float high = larger(larger(a[u], b[u]), c[u]), low = smaller(smaller(a[u], b[u]), c[u]);
    const int lit = high >= saturated_dn ? kFull : (sigma[u] < max_sigma ? kNone : kNoisy);
    reject[u] = static_cast<PixelReject>(((high <= dark_dn) | (low < clip_dn)) ? kDark : lit);
  }
}

/// Three phase frames of one pixel solved: A, C = B cos(phi), S = B sin(phi), and the variance of phi times B^4.
struct ThreeFrames {
  float mean, cosine, sine, variance_b4;
};

/// Frames by slot: the three phase frames, then the code frame.
using FrameRoles = std::array<std::size_t, 4>;

/// solve(i_a, i_b, i_c, noise): the mode's equations, inlined into a loop that vectorises, for the instruction set of
/// whoever calls.
template <class Solve>
[[gnu::always_inline]] inline void solve_row(const FrameRows& rows, const FrameRoles& roles, const NoiseModel noise,
                                             float saturated_dn, std::size_t at, PhaseMaps& maps, const Solve solve) {
  const std::size_t width = rows[0].size();
  const float* __restrict a = rows[roles[0]].data();
  const float* __restrict b = rows[roles[1]].data();
  const float* __restrict c = rows[roles[2]].data();
  const float* __restrict coded = rows[roles[3]].data();
  float* __restrict mean = &maps.mean_dn[at], * __restrict cosine = &maps.cosine_dn[at];
  float* __restrict sine = &maps.sine_dn[at], * __restrict code = &maps.code_dn[at];
  float* __restrict modulation = &maps.modulation_dn[at], * __restrict phase = &maps.phase_rad[at];
  float* __restrict sigma = &maps.sigma_rad[at];
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const ThreeFrames f = solve(a[u], b[u], c[u], noise);
    const float b2 = f.cosine * f.cosine + f.sine * f.sine + 1e-6F;
    mean[u] = f.mean;
    cosine[u] = f.cosine;
    sine[u] = f.sine;
    code[u] = select(coded[u] < saturated_dn, coded[u] - f.mean, std::numeric_limits<float>::quiet_NaN());
    modulation[u] = root(b2);
    phase[u] = atan2_poly(f.sine, f.cosine);
    sigma[u] = root(f.variance_b4 + 1e-12F) / b2;  // frames exactly alike have no phase: sigma is 1, not 0
  }
}

template <class Solve>
[[gnu::always_inline]] inline void solve_burst(const BurstView& view, const NoiseModel& noise,
                                               const PhaseConfig& config, const FrameRoles& roles, PhaseMaps& maps,
                                               const Solve solve) {
  maps.resize(view.width, view.height);
  const auto width = static_cast<std::size_t>(view.width);
  FrameRows rows;
  for (auto& row : rows) row.resize(width);
  for (std::size_t v = 0; v < static_cast<std::size_t>(view.height); ++v) {
    load_row(view, v, rows);
    const std::size_t at = v * width;
    solve_row(rows, roles, noise, config.saturation * noise.full_scale_dn, at, maps, solve);
    mask_row({rows[roles[0]].data(), rows[roles[1]].data(), rows[roles[2]].data()}, width, noise, config,
             &maps.sigma_rad[at], &maps.reject[at]);
  }
}

}  // namespace enamel::pipeline
