#include "pipeline/algo/phase/polarity.hpp"

#include <algorithm>

#include "pipeline/algo/phase/poly_trig.hpp"

namespace enamel::algo {
namespace {

struct SpanState {
  float sign;
  float low_flip, high_flip;  ///< 0 when the cell's border is a flip, else far away: added to the distance
  float origin;               ///< phase of the cell's lower border in the pixel's own wrap
  int turn;
};

SpanState state_of(const CellSpan& s, const CellSigns& signs) {
  constexpr float kFar = 10;
  const float b = signs.at(s.cell);
  const bool odd = (s.cell & 1) != 0;
  return {b, signs.at(s.cell - 1) * b > 0 ? kFar : 0, signs.at(s.cell + 1) * b > 0 ? kFar : 0, odd ? -kPiF : 0,
          odd ? (s.cell + 1) / 2 : s.cell / 2};
}

void solve_span(std::size_t begin, std::size_t end, const SpanState st, const NoiseModel noise,
                const PolarityConfig config, PhaseMaps& m, PolarityMaps& out) {
  const float ramp = 1.0F / (config.flip_full_rad - config.flip_drop_rad);
  const float* __restrict mean = m.mean_dn.pixels().data();
  const float* __restrict cosine = m.cosine_dn.pixels().data();
  float* __restrict sine = m.sine_dn.pixels().data();
  float* __restrict code = m.code_dn.pixels().data();
  float* __restrict modulation = m.modulation_dn.pixels().data();
  float* __restrict phase = m.phase_rad.pixels().data();
  float* __restrict sigma = m.sigma_rad.pixels().data();
  float* __restrict weight = out.weight.pixels().data();
  std::int16_t* __restrict turn = out.turn.pixels().data();
  const float b = st.sign;
  ENAMEL_INDEPENDENT
  for (std::size_t i = begin; i < end; ++i) {
    const float a = mean[i], c = cosine[i], s3 = sine[i], d = code[i], old = phase[i];
    const float t = old - st.origin;
    const float to_low = t + st.low_flip, to_high = kPiF - t + st.high_flip;
    const float x = (smaller(to_low, to_high) - config.flip_drop_rad) * ramp;
    const bool usable = d == d;
    const float w = select(usable, smaller(larger(x, 0), 1), 0);
    const float bd = select(usable, b * d, s3);
    const float s = s3 + 0.5F * w * (bd - s3);
    const float g = 1 - 0.5F * w * (1 + b);
    const float e0 = 0.5F * (c * g - s), e2 = 0.5F * (c * g + s), e1 = c * (1 - 0.5F * w), e3 = 0.5F * c * w;
    const float var = e0 * e0 * noise.variance(a + c) + e2 * e2 * noise.variance(a - c) +
                      e1 * e1 * noise.variance(a - s3) + e3 * e3 * noise.variance(a + b * bd);
    const float b2 = c * c + s * s + 1e-6F;
    const float p = atan2_poly(s, c);
    const int step = static_cast<int>(p - old > kPiF) - static_cast<int>(p - old < -kPiF);
    sine[i] = s;
    code[i] = s3 - b * d;
    modulation[i] = root(b2);
    phase[i] = p;
    sigma[i] = root(var) / b2;
    weight[i] = b * w;
    turn[i] = static_cast<std::int16_t>(st.turn - step);
  }
}

}  // namespace

void apply_polarity(std::span<const CellSpan> spans, const CellSigns& signs, const NoiseModel& noise,
                    const PolarityConfig& config, PhaseMaps& maps, PolarityMaps& out) {
  const int w = maps.phase_rad.width(), h = maps.phase_rad.height();
  if (out.weight.width() != w || out.weight.height() != h) {
    out.weight = Map<float>(w, h);
    out.turn = Map<std::int16_t>(w, h);
  }
  std::fill(out.weight.pixels().begin(), out.weight.pixels().end(), 0.0F);
  for (const CellSpan& s : spans) {
    const std::size_t at = static_cast<std::size_t>(s.row) * static_cast<std::size_t>(w);
    solve_span(at + static_cast<std::size_t>(s.begin), at + static_cast<std::size_t>(s.end), state_of(s, signs), noise,
               config, maps, out);
  }
}

}  // namespace enamel::algo
