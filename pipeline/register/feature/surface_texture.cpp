#include "pipeline/register/feature/surface_texture.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/register/feature/masked_means.hpp"

namespace enamel::pipeline {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Map<float> on_surface(const SurfacePatch& patch) {
  Map<float> out = patch.texture_dn;
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (!std::isfinite(patch.depth_mm[i])) out[i] = kNan;
  }
  return out;
}

Map<float> brightness_map(const SurfacePatch& patch, int step, int radius, double known_around) {
  const Masked texture = block_means(on_surface(patch), step);
  const Masked around = lowpass(texture, radius);
  const double full = std::pow(2 * radius + 1, 4);
  Map<float> out(texture.value.width(), texture.value.height(), kNan);
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (texture.weight[i] <= 0 || around.weight[i] < known_around * full) continue;
    out[i] = static_cast<float>(brightness_of(texture.value[i], around.value[i]));
  }
  return out;
}

/// At the middle of each block.
Map<float> phase_map(const SurfacePatch& patch, int step, const FringePhase& phase) {
  Map<float> out(patch.depth_mm.width() / step, patch.depth_mm.height() / step);
  for (int v = 0; v < out.height(); ++v) {
    for (int u = 0; u < out.width(); ++u) out(u, v) = static_cast<float>(phase(block_point(patch, step, u, v)));
  }
  return out;
}

}  // namespace

TexturePicture make_texture_picture(const SurfacePatch& patch, double px_per_mm, const FringePhase& phase,
                                    const SurfaceTextureConfig& config) {
  TexturePicture out;
  out.step = block_px(patch, config.images);
  out.range = config.images.texture_range;
  Map<float> brightness =
      brightness_map(patch, out.step, lowpass_radius(out.step, px_per_mm, config.images), config.known_around);
  remove_fringes(brightness, phase_map(patch, out.step, phase), config.fringe_tile_px);
  out.grey = Map<std::uint8_t>(brightness.width(), brightness.height(), TexturePicture::kUnknown);
  for (std::size_t i = 0; i < out.grey.size(); ++i) {
    // Beyond the range it is a limb or a shadow's edge, which light draws and not the surface. NaN fails too.
    if (!(std::abs(brightness[i]) < static_cast<float>(out.range))) continue;
    out.grey[i] = std::max(std::uint8_t{1}, to_grey(static_cast<double>(brightness[i]) / out.range));
  }
  return out;
}

}  // namespace enamel::pipeline
