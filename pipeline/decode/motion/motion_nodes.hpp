// What each of the six unknowns of a rigid motion does to phase and light at every node of a grid over the image: the
// equations of rigid_motion.hpp, with the slopes that the images show. Private to pipeline/decode.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pipeline/decode/motion/motion_images.hpp"
#include "pipeline/decode/motion/motion_samples.hpp"
#include "pipeline/decode/phase/phase.hpp"
#include "pipeline/decode/triangulate/ray_depth.hpp"

namespace enamel::pipeline {

enum class NodeQuality : std::uint8_t {
  kNoSlope,
  kTooSteep,  ///< or at the picture's border: known, and not asked how the burst moved
  kFits,
};

struct MotionNodes {
  int columns = 0, rows = 0;
  std::vector<float> rate, light;  ///< eps and dA/A by a unit of (V, W), unknown k of node n at [k * count() + n]
  std::vector<NodeQuality> quality;
  std::vector<float> slopes;  ///< scratch, a row's

  [[nodiscard]] std::size_t count() const noexcept {
    return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  }
  [[nodiscard]] bool has_slope(std::size_t n) const noexcept { return quality[n] != NodeQuality::kNoSlope; }
};

/// The image's pixel at the middle of a node.
[[nodiscard]] inline std::size_t pixel_of_node(const PhaseMaps& maps, int column, int row) noexcept {
  return maps.phase_rad.index(column * kNode_px + kNode_px / 2, row * kNode_px + kNode_px / 2);
}

/// Depth of the point on the optical axis that turns are about: the middle of the range in 1/z.
[[nodiscard]] inline float pivot_depth_mm(const RayDepth& rays) noexcept {
  return 2 / (1 / rays.near_mm + 1 / rays.far_mm);
}

/// Of all nodes of an image of that size; `wraps` makes the phase of `maps` absolute.
void find_nodes(const MotionImages& images, const PhaseMaps& maps, const Map<std::int16_t>& wraps, const RayDepth& rays,
                MotionNodes& out);

/// Of the sampled nodes.
void take_columns(const MotionNodes& nodes, const MotionSamples& samples, MotionColumns& out);

}  // namespace enamel::pipeline
