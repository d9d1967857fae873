#include "pipeline/algo/phase/saturated.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "pipeline/algo/phase/frame_rows.hpp"
#include "pipeline/algo/phase/poly_trig.hpp"

namespace enamel::algo {
namespace {

using Frames = std::array<float, 4>;

/// A, C and S as weights of the four frames, by the frame that is missing.
struct Weights {
  Frames mean, cosine, sine;
};
constexpr std::array<Weights, 3> kWithout = {{{{0, 0.5F, 0, 0.5F}, {0, 0.5F, -1, 0.5F}, {0, -0.5F, 0, 0.5F}},
                                              {{0.5F, 0, 0.5F, 0}, {0.5F, 0, -0.5F, 0}, {-0.5F, 0, -0.5F, 1}},
                                              {{0, 0.5F, 0, 0.5F}, {1, -0.5F, 0, -0.5F}, {0, -0.5F, 0, 0.5F}}}};

float dot(const Frames& w, const Frames& dn) { return w[0] * dn[0] + w[1] * dn[1] + w[2] * dn[2] + w[3] * dn[3]; }

/// sigma of atan2(s, c) by first-order propagation of the frames' noise.
float sigma_of(const Weights& w, float c, float s, const Frames& dn, const NoiseModel& noise) {
  float variance_b4 = 1e-12F;  // as in frame_rows.hpp
  for (std::size_t k = 0; k < 4; ++k) {
    const float e = c * w.sine[k] - s * w.cosine[k];
    variance_b4 += e * e * noise.variance(dn[k]);
  }
  return root(variance_b4) / (c * c + s * s + 1e-6F);
}

/// The saturated frame of a pixel with but one, else 4.
std::size_t only_saturated(const Frames& dn, float saturated_dn) {
  std::size_t missing = 4, count = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    if (dn[k] >= saturated_dn) missing = k, ++count;
  }
  return count == 1 ? missing : 4;
}

/// What the three frames are worth, by the mask's own rules.
bool solve_pixel(const Frames& dn, std::size_t missing, std::size_t i, const NoiseModel& noise,
                 const PhaseConfig& config, PhaseMaps& m) {
  for (std::size_t k = 0; k < 4; ++k) {
    if (noise.black_dn > 0 && dn[k] < 0.5F) return false;
  }
  const Weights& w = kWithout[missing];
  const float c = dot(w.cosine, dn), s = dot(w.sine, dn);
  const float sigma = sigma_of(w, c, s, dn, noise);
  if (!(sigma < config.max_sigma_rad)) return false;
  m.mean_dn[i] = dot(w.mean, dn);
  m.cosine_dn[i] = c;
  m.sine_dn[i] = s;
  m.code_dn[i] = missing == 1 ? s : std::numeric_limits<float>::quiet_NaN();
  m.modulation_dn[i] = root(c * c + s * s + 1e-6F);
  m.phase_rad[i] = atan2_poly(s, c);
  m.sigma_rad[i] = sigma;
  m.reject[i] = PixelReject::kNone;
  return true;
}

/// Whether frame 3 is A + S throughout flip_full_rad around the absolute phase phi + 2 pi turn.
bool is_plain(float phi, int turn, const CellSigns& signs, float reach_rad) {
  const int cell = 2 * turn - static_cast<int>(phi < 0);
  const float above = phi < 0 ? phi + kPiF : phi;  // distance to the cell's lower border
  return signs.at(cell) > 0 && (above >= reach_rad || signs.at(cell - 1) > 0) &&
         (kPiF - above >= reach_rad || signs.at(cell + 1) > 0);
}

/// A frame is A + cosine C + sine S, with C = B cos phi and S = B sin phi at mid-burst.
struct Phasor {
  float cosine = 0, sine = 0;
};
using Waves = std::array<Phasor, 4>;

/// Of frame k = 0 ... 3 with b = +1, whose phase is `turned` ahead of mid-burst, less than a quarter turn.
Phasor wave_of(std::size_t k, float turned) {
  const float c = cos_poly(turned), s = sin_poly(turned);
  return std::array<Phasor, 4>{{{c, -s}, {-s, -c}, {-c, s}, {s, c}}}[k];
}

/// C and S by the three frames other than `missing`.
Phasor solve(const Waves& waves, const Frames& x, std::size_t missing) {
  std::array<std::size_t, 3> used{};
  for (std::size_t k = 0, to = 0; k < waves.size(); ++k)
    if (k != missing) used.at(to++) = k;
  const auto step = [&](std::size_t k) {
    return Phasor{waves[used[k]].cosine - waves[used[0]].cosine, waves[used[k]].sine - waves[used[0]].sine};
  };
  const Phasor p = step(1), q = step(2);
  const float y = x[used[1]] - x[used[0]], z = x[used[2]] - x[used[0]], det = p.cosine * q.sine - p.sine * q.cosine;
  return {(y * q.sine - p.sine * z) / det, (p.cosine * z - y * q.cosine) / det};
}

/// B cos of twice a frame's phase.
float harmonic_of(const Phasor& at, const Phasor& wave) {
  const float b = root(at.cosine * at.cosine + at.sine * at.sine + 1e-6F);
  const float in_phase = wave.cosine * at.cosine + wave.sine * at.sine;
  return 2 * in_phase * in_phase / b - b;
}

}  // namespace

void solve_saturated(const BurstView& view, const NoiseModel& noise, const PhaseConfig& config, PhaseMaps& maps,
                     std::vector<SaturatedPixel>& out) {
  out.clear();
  const auto width = static_cast<std::size_t>(view.width);
  const float saturated_dn = config.saturation * noise.full_scale_dn;
  FrameRows rows;
  for (auto& row : rows) row.resize(width);
  for (std::size_t v = 0; v < static_cast<std::size_t>(view.height); ++v) {
    const PixelReject* reject = &maps.reject[v * width];
    if (std::memchr(reject, static_cast<int>(PixelReject::kSaturated), width) == nullptr) continue;
    load_row(view, v, rows);
    for (std::size_t u = 0; u < width; ++u) {
      if (reject[u] != PixelReject::kSaturated) continue;
      const Frames dn = {rows[0][u], rows[1][u], rows[2][u], rows[3][u]};
      const std::size_t missing = only_saturated(dn, saturated_dn), i = v * width + u;
      if (missing < 3 && solve_pixel(dn, missing, i, noise, config, maps))
        out.push_back({i, static_cast<std::uint8_t>(missing)});
    }
  }
}

void sort_out_saturated(const std::vector<SaturatedPixel>& pixels, const CellSigns& signs, const NoiseModel& noise,
                        const PolarityConfig& config, const Map<std::int16_t>& turn, PhaseMaps& maps) {
  for (const SaturatedPixel& p : pixels) {
    const std::size_t i = p.index;
    maps.code_dn[i] = std::numeric_limits<float>::quiet_NaN();  // three frames for three unknowns: no residual
    if (maps.reject[i] != PixelReject::kNone) continue;
    if (!is_plain(maps.phase_rad[i], turn[i], signs, config.flip_full_rad)) {
      maps.reject[i] = PixelReject::kSaturated;
      continue;
    }
    const float a = maps.mean_dn[i], c = maps.cosine_dn[i], s = maps.sine_dn[i];
    maps.sigma_rad[i] = sigma_of(kWithout[p.missing], c, s, {a + c, a - s, a - c, a + s}, noise);
  }
}

void correct_saturated(const std::vector<SaturatedPixel>& pixels, const BurstErrors& errors, float black_dn,
                       const PhaseMaps& maps, std::vector<float>& phase_rad) {
  const int width = maps.phase_rad.width();
  GridRows motion(errors.motion_rad, width), change(errors.motion_change, width), harmonic(errors.harmonic, width);
  GridRows light(errors.light, width), light_change(errors.light_change, width);
  const float *rate = nullptr, *rate_change = nullptr, *rho = nullptr, *growth = nullptr, *growth_change = nullptr;
  phase_rad.clear();
  int row = -1;
  for (const SaturatedPixel& p : pixels) {
    const std::size_t i = p.index, u = i % static_cast<std::size_t>(width);
    const int v = static_cast<int>(i / static_cast<std::size_t>(width));
    if (v != row) {
      rate = motion.row(v), rate_change = change.row(v), rho = harmonic.row(v);
      growth = light.row(v), growth_change = light_change.row(v), row = v;
    }
    const float a = maps.mean_dn[i] - black_dn, c = maps.cosine_dn[i], s = maps.sine_dn[i];
    Frames x = {a + c, a - s, a - c, a + s};
    Waves waves{};
    for (std::size_t k = 0; k < x.size(); ++k) {
      const float t = static_cast<float>(k) - 1.5F, turned = t * rate[u] + 0.5F * t * t * rate_change[u];
      waves[k] = wave_of(k, turned);
      x[k] /= 1 + t * growth[u] + 0.5F * t * t * growth_change[u];
    }
    Phasor at = solve(waves, x, p.missing);
    for (std::size_t k = 0; k < x.size(); ++k) x[k] -= rho[u] * harmonic_of(at, waves[k]);
    at = solve(waves, x, p.missing);
    phase_rad.push_back(maps.phase_rad[i] + atan2_poly(at.sine * c - at.cosine * s, at.cosine * c + at.sine * s));
  }
}

}  // namespace enamel::algo
