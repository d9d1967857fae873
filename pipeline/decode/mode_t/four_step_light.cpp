#include "pipeline/decode/mode_t/four_step_light.hpp"

#include <cmath>

#include "pipeline/decode/mode_t/chosen.hpp"
#include "pipeline/decode/mode_t/closure_rows.hpp"
#include "pipeline/decode/mode_t/frame_solve.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"

namespace enamel::pipeline {
namespace {

/// derived: variance over that of a frame, the mean over a fringe: of B, with 1/2 of C and 3/2 of S; of what frame 3
/// shows beyond A + b S: 4 where b = +1, else 2.
constexpr float kFringeVariance = 1, kRestVariance = 4;

/// The three frames' own S and the sign of the fourth: polarity.hpp, backwards.
[[gnu::always_inline]] inline float sine_of_three(float sine, float weight, float residual) {
  return sine + 0.5F * std::abs(weight) * select(residual == residual, residual, 0);
}

void light_row(const PixelRow& in, const PixelReject* of_row, const NoiseModel& model, float limit, std::size_t width,
               const LightRow& out) {
  const NoiseModel noise = model;  // a copy cannot alias what is written
  const float* __restrict c = in.cosine, * __restrict s = in.sine, * __restrict r = in.code, * __restrict mean = in.mean;
  const float* __restrict w = in.errors.weight, * __restrict rate = in.errors.rate, * __restrict rho = in.errors.harmonic;
  const float* __restrict growth = in.errors.light, * __restrict rate_change = in.errors.rate_change;
  const float* __restrict growth_change = in.errors.light_change;
  const PixelReject* __restrict reject = of_row;
  const float black_dn = in.errors.black_dn, full = kBrightest * model.full_scale_dn - black_dn;
  float* __restrict light = out.light, * __restrict cosine = out.cosine, * __restrict sine = out.sine;
  float* __restrict rest = out.rest, * __restrict by_sine = out.rest_by_sine, * __restrict by_gain = out.rest_by_gain;
  float* __restrict weight = out.weight, * __restrict sure = out.rest_weight;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const PixelChange d{rate[u], rate_change[u], growth[u], growth_change[u]};
    const Turns turns = turns_of<false>(d);
    const float a = mean[u] - black_dn, b = std::copysign(1.0F, w[u]), s3 = sine_of_three(s[u], w[u], r[u]);
    const float seen = select(r[u] == r[u], r[u], 0);
    const FourFrames x{(a + c[u]) / d.light(-1.5F), (a - s3) / d.light(-0.5F), (a - c[u]) / d.light(0.5F),
                       (a + b * (s3 - seen)) / d.light(1.5F)};
    const FourStepPixel p = solve_first_three(x, turns);
    const FourFrames h = harmonic_of(p, turns);
    const FourStepPixel of_h = solve_first_three(h, turns);
    const float lit = p.mean - rho[u] * of_h.mean, cos = p.cosine - rho[u] * of_h.cosine,
                sin = p.sine - rho[u] * of_h.sine;
    const float fringe = sin * turns.a3.cos + cos * turns.a3.sin;
    const float off = x.x3 - rho[u] * h.x3 - lit - b * fringe, modulation = root(cos * cos + sin * sin + 1e-6F);
    light[u] = lit, cosine[u] = cos, sine[u] = sin, rest[u] = off;
    by_sine[u] = -b, by_gain[u] = b * fringe;
    const bool inside =
        ((w[u] != 0) | (r[u] == r[u])) & (reject[u] == PixelReject::kNone) & (lit > 1) & (a + modulation < full);
    const float decided = std::abs(w[u]), apart = std::abs(off);
    const bool known = inside & (decided > 0.999F) & (r[u] == r[u]) & (apart < limit * modulation);
    const float inverse = 1 / noise.variance(mean[u]);
    weight[u] = select(inside, inverse / kFringeVariance, 0);
    sure[u] = select(known, inverse / kRestVariance, 0);
  }
}

}  // namespace

bool find_four_step_light(const KnownBurst& burst, const LightQuestion& question, LightChange& light) {
  const LightChangeConfig& config = question.config;
  const int width = burst.maps.phase_rad.width(), height = burst.maps.phase_rad.height();
  const auto columns = static_cast<std::size_t>(width);
  ErrorRows rows(burst.errors, burst.black_dn, width);
  light.start(width, height, config, question.of);
  const LightRow out = light.row();
  for (int v = config.row_step / 2; v < height; v += config.row_step) {
    light_row(pixel_row(burst.maps, rows.at(burst.polarity, v), burst.maps.phase_rad.index(0, v)),
              &burst.maps.reject(0, v), question.noise, question.max_residual, columns, out);
    light.take_row(v);
  }
  return light.find(question.motion_rad);
}

void take_off_light(const LightChange& light, std::span<const CellSpan> spans, const PolarityMaps& polarity,
                    float black_dn, PhaseMaps& maps) {
  const int width = maps.phase_rad.width();
  GridRows cosines(light.share(0), width), sines(light.share(1), width), rests(light.share(2), width);
  for (int v = 0; v < maps.phase_rad.height(); ++v) {
    const float *of_cosine = cosines.row(v), *of_sine = sines.row(v), *of_rest = rests.row(v);
    const std::size_t first = maps.phase_rad.index(0, v);
    for (std::size_t u = 0; u < static_cast<std::size_t>(width); ++u) {
      const std::size_t i = first + u;
      const float weight = polarity.weight[i], b = std::copysign(1.0F, weight), residual = maps.code_dn[i];
      const float a = lamp_base_dn(light.light_of(), larger(maps.mean_dn[i] - black_dn, 0)),
                  three = sine_of_three(maps.sine_dn[i], weight, residual);
      const float cosine = maps.cosine_dn[i] - of_cosine[u] * a, sine = three - of_sine[u] * a;
      maps.cosine_dn[i] = cosine, maps.sine_dn[i] = sine;
      maps.code_dn[i] = b * (three - residual) - of_rest[u] * a;
      maps.modulation_dn[i] = root(cosine * cosine + sine * sine + 1e-6F);
      maps.phase_rad[i] = atan2_poly(sine, cosine);
    }
  }
  for (const CellSpan& s : spans) {
    const float middle = (s.cell & 1) != 0 ? -0.5F * kPiF : 0.5F * kPiF;
    float* phase = &maps.phase_rad(0, s.row);
    for (std::int32_t u = s.begin; u < s.end; ++u) phase[u] = middle + wrap_once(phase[u] - middle);
  }
}

}  // namespace enamel::pipeline
