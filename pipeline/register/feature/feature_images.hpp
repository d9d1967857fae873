// The two grey pictures that features are sought in: the surface's look and its fine relief.
#pragma once

#include <cstdint>

#include "pipeline/types/map.hpp"
#include "pipeline/types/patch.hpp"
#include "pipeline/types/texture_picture.hpp"

namespace enamel::pipeline {

struct ImageConfig {
  int target_width_px = 213;     ///< pictures are block means of the patch, about this wide (a pixel: 85 µm)
  double lowpass_mm = 1.0;       ///< what varies over more than this (form, shading) is taken out
  double relief_range_mm = 0.5;  ///< relief of ±this fills 0 … 255
  double texture_range = 0.25;   ///< brightness of (1 ± this) times its surroundings fills 0 … 255
  double known_around = 0.97;    ///< chosen: of the surroundings of a place, the share that must be surface for its
                                 ///< brightness beside them to mean the place and not the border of the light
};

struct FeatureImages {
  int step = 1;  ///< picture pixel (i, j) is the mean of camera pixels step*i … step*i + step-1
  Map<std::uint8_t> texture;
  Map<std::uint8_t> relief;  ///< 128 where there is no surface
};

/// px_per_mm: camera pixels a millimetre on a facing surface at mid-depth. Pure.
[[nodiscard]] FeatureImages make_feature_images(const SurfacePatch& patch, double px_per_mm, const ImageConfig& config);

/// The texture of the surface alone: unknown beside the border of what was measured, which moves with the camera. Pure.
[[nodiscard]] TexturePicture make_texture_picture(const SurfacePatch& patch, double px_per_mm,
                                                  const ImageConfig& config);

}  // namespace enamel::pipeline
