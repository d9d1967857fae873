#include "pipeline/register/feature/feature_images.hpp"

#include "pipeline/register/feature/masked_means.hpp"

namespace enamel::pipeline {

FeatureImages make_feature_images(const SurfacePatch& patch, double px_per_mm, const ImageConfig& config) {
  FeatureImages out;
  out.step = block_px(patch, config);
  const int radius = lowpass_radius(out.step, px_per_mm, config);
  const Masked texture = block_means(patch.texture_dn, out.step);
  const Masked depth = block_means(patch.depth_mm, out.step);
  const Map<double> smooth_texture = lowpass(texture, radius).value;
  const Map<double> smooth_depth = lowpass(depth, radius).value;
  out.texture = Map<std::uint8_t>(texture.value.width(), texture.value.height(), 128);
  out.relief = out.texture;
  for (std::size_t i = 0; i < out.texture.size(); ++i) {
    const double brightness = brightness_of(texture.value[i], smooth_texture[i]);
    if (texture.weight[i] > 0) out.texture[i] = to_grey(brightness / config.texture_range);
    if (depth.weight[i] > 0) out.relief[i] = to_grey((depth.value[i] - smooth_depth[i]) / config.relief_range_mm);
  }
  return out;
}

}  // namespace enamel::pipeline
