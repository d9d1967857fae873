// Pixels whose order became known join the patch.
#pragma once

#include <cstdint>
#include <span>

#include "pipeline/decode/triangulate/normals.hpp"
#include "pipeline/decode/triangulate/ray_depth.hpp"
#include "pipeline/types/patch.hpp"
#include "pipeline/types/relative_surface.hpp"

namespace enamel::pipeline {

/// Depth, sigma and points of the decided pixels that lie in the depth range and the projector's frame, then the
/// normals of the whole patch anew. orders: of the pixels, see ModelGuide::decide. Returns the number of pixels added;
/// 0 leaves the patch as it was.
std::size_t add_decided(const RelativeSurface& relative, std::span<const std::int32_t> orders, const RayDepth& rays,
                        const NormalConfig& config, SurfacePatch& patch);

}  // namespace enamel::pipeline
