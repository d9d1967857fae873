#include "pipeline/decode/mode_m/micro_light.hpp"

#include "pipeline/decode/mode_m/micro_light_rows.hpp"
#include "pipeline/decode/mode_m/micro_spans.hpp"

namespace enamel::pipeline {

bool find_micro_light(const MicroBurst& burst, const MicroMotion& motion, float max_residual,
                      const LightChangeConfig& config, LampLight of, LightChange& light) {
  const int height = burst.wraps.height();
  const auto width = static_cast<std::size_t>(burst.wraps.width());
  CodeRows rows(motion, burst.maps, &burst.wraps);
  rows.expect(burst.code, burst.third_rad);
  light.start(burst.wraps.width(), height, config, of);
  const LightRow out = light.row();
  for (int v = config.row_step / 2; v < height; v += config.row_step) {
    micro_light_row(rows.at(v), burst.noise, max_residual, width, out);
    const PixelReject* reject = &burst.maps.reject(0, v);
    for (std::size_t u = 0; u < width; ++u) {
      if (reject[u] != PixelReject::kNone) out.weight[u] = out.rest_weight[u] = 0;
    }
    light.take_row(v);
  }
  return light.find(motion.motion_rad);
}

void take_off_light(const LightChange& light, float black_dn, PhaseMaps& maps) {
  const int width = maps.phase_rad.width();
  GridRows cosine(light.share(0), width), sine(light.share(1), width), rest(light.share(2), width);
  for (int v = 0; v < maps.phase_rad.height(); ++v) {
    take_light_off_row({cosine.row(v), sine.row(v), rest.row(v), light.light_of()}, black_dn,
                       static_cast<std::size_t>(width),
                       {&maps.mean_dn(0, v), &maps.cosine_dn(0, v), &maps.sine_dn(0, v), &maps.code_dn(0, v),
                        &maps.modulation_dn(0, v), &maps.phase_rad(0, v)});
  }
}

}  // namespace enamel::pipeline
