#include "tools/twin/surface/texture.hpp"

#include <algorithm>
#include <cmath>

#include "tools/twin/surface/noise.hpp"

namespace enamel::twin {
namespace {

/// 1 where smooth noise changes its sign: a net of winding lines.
double line(const Vec3d& p, std::uint64_t seed) {
  constexpr double kWidth = 0.07;  // in levels of the noise, which changes by about 1.5 over a patch
  const double level = value_noise(p, seed) / kWidth;
  return std::exp(-level * level);
}

/// Fine vessels and, half as many again, wide ones.
double vessel(const Vec3d& p, std::uint64_t seed) {
  constexpr double kWideToFine = 2.7;
  constexpr double kFineShare = 0.6;  // of the wide ones' depth
  return std::max(kFineShare * line(p, seed ^ 0x66696EULL), line(p / kWideToFine, seed ^ 0x776964ULL));
}

}  // namespace

void apply_texture(TriSurface& surface, const TextureConfig& config, std::uint64_t seed) {
  if (config.amplitude <= 0) return;
  for (std::size_t i = 0; i < surface.vertices.size(); ++i) {
    const Vec3d p = surface.vertices[i].cast<double>() / config.scale_mm;
    const double change = config.pattern == TexturePattern::kVessels ? -vessel(p, seed) : value_noise(p, seed);
    surface.albedo[i] *= static_cast<float>(1.0 + config.amplitude * change);
  }
}

}  // namespace enamel::twin
