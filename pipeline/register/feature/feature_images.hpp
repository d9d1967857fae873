// The two grey pictures that features are sought in: the surface's look and its fine relief.
#pragma once

#include <cstdint>

#include "pipeline/types/map.hpp"
#include "pipeline/types/patch.hpp"

namespace enamel::pipeline {

struct ImageConfig {
  int target_width_px = 213;     ///< pictures are block means of the patch, about this wide (a pixel: 85 µm)
  double lowpass_mm = 1.0;       ///< what varies over more than this (form, shading) is taken out
  double relief_range_mm = 0.5;  ///< relief of ±this fills 0 … 255
  double texture_range = 0.25;   ///< brightness of (1 ± this) times its surroundings fills 0 … 255
};

struct FeatureImages {
  int step = 1;  ///< picture pixel (i, j) is the mean of camera pixels step*i … step*i + step-1
  Map<std::uint8_t> texture;
  Map<std::uint8_t> relief;  ///< 128 where there is no surface
};

/// px_per_mm: camera pixels a millimetre on a facing surface at mid-depth. Pure.
[[nodiscard]] FeatureImages make_feature_images(const SurfacePatch& patch, double px_per_mm, const ImageConfig& config);

}  // namespace enamel::pipeline
