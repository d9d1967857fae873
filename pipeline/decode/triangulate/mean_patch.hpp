// Several bursts of a head and an object that both stand still, as one patch: less noise, and with several exposures
// dark and glossy places too.
#pragma once

#include <span>

#include "pipeline/decode/triangulate/normals.hpp"
#include "pipeline/decode/triangulate/ray_depth.hpp"
#include "pipeline/types/patch.hpp"

namespace enamel::pipeline {

struct MeanConfig {
  double gate_sigmas =
      4;  ///< chosen: by judgement; farther from the middle of the bursts than their noise allows: left out
  int min_agreeing = 2;  ///< chosen: by judgement; bursts that must tell the same of a pixel, where there are so many
};

/// Pixel by pixel: depths near their median, weighed by 1/sigma^2; sigma is that of the mean. A pixel that fewer than
/// min_agreeing bursts agree on is left out, unless that many bursts were not given. Texture: of the first burst that
/// has one. Points and normals anew from the depth. Empty without patches; those of another size are passed over.
[[nodiscard]] SurfacePatch mean_patch(std::span<const SurfacePatch> patches, const RayDepth& rays,
                                      const NormalConfig& normals, const MeanConfig& config);

}  // namespace enamel::pipeline
