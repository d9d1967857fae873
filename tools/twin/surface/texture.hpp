// How the reflectance of a surface varies over it, per vertex.
#pragma once

#include <cstdint>

#include "tools/twin/surface/tri_surface.hpp"

namespace enamel::twin {

enum class TexturePattern : std::uint8_t {
  kMottle,   ///< albedo *= 1 + amplitude * noise(p / scale), noise in [-1, 1]
  kVessels,  ///< dark branching lines: albedo *= 1 - amplitude * line(p), line in [0, 1]
};

struct TextureConfig {
  TexturePattern pattern = TexturePattern::kMottle;
  double amplitude = 0.05;
  double scale_mm = 1.6;  ///< size of a patch, or of the mesh between fine vessels
};

void apply_texture(TriSurface& surface, const TextureConfig& config, std::uint64_t seed);

}  // namespace enamel::twin
