// The texture of a surface alone: what stays where it is when camera, light and fringes move.
#pragma once

#include "pipeline/register/feature/feature_images.hpp"
#include "pipeline/register/feature/fringe_residue.hpp"
#include "pipeline/types/patch.hpp"
#include "pipeline/types/texture_picture.hpp"

namespace enamel::pipeline {

struct SurfaceTextureConfig {
  ImageConfig images;          ///< blocks, surroundings, range
  double known_around = 0.97;  ///< chosen: of the surroundings of a place, the share that must be surface for its
                               ///< brightness beside them to mean the place and not the border of the light
  int fringe_tile_px = 16;  ///< chosen: blocks; with its neighbours a tile spans four millimetres, five fringes or so
};

/// Brightness beside the surroundings, without what follows the fringes; unknown beside the border of what was
/// measured. px_per_mm as make_feature_images. Pure.
[[nodiscard]] TexturePicture make_texture_picture(const SurfacePatch& patch, double px_per_mm, const FringePhase& phase,
                                                  const SurfaceTextureConfig& config);

}  // namespace enamel::pipeline
