#include "pipeline/decode/mode_t/four_step_light.hpp"

#include <cmath>

#include "pipeline/decode/mode_t/closure_rows.hpp"
#include "pipeline/decode/mode_t/four_step_light_rows.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"

namespace enamel::pipeline {
bool find_four_step_light(const KnownBurst& burst, const LightQuestion& question, LightChange& light) {
  const LightChangeConfig& config = question.config;
  const int width = burst.maps.phase_rad.width(), height = burst.maps.phase_rad.height();
  const auto columns = static_cast<std::size_t>(width);
  ErrorRows rows(burst.errors, burst.black_dn, width);
  light.start(width, height, config, question.of);
  const LightRow out = light.row();
  for (int v = config.row_step / 2; v < height; v += config.row_step) {
    four_step_light_row(pixel_row(burst.maps, rows.at(burst.polarity, v), burst.maps.phase_rad.index(0, v)),
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
