// A decoded patch as small as it can be kept: a scan's bursts stay in memory until it is known where they belong.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "pipeline/decode/triangulate/normals.hpp"
#include "pipeline/decode/triangulate/ray_depth.hpp"
#include "pipeline/types/patch.hpp"

namespace enamel::pipeline {

/// Depth of the valid pixels in 65 535 steps over its range (a third of a micron at most in any rig's range: a
/// thirtieth of its sigma), sigma in steps of 4.4 %, texture, where it is kept, in 1/16 DN up to 4095: a tenth of the
/// maps.
struct PackedPatch {
  struct Run {
    std::uint32_t begin = 0, count = 0;  ///< pixels, row major
  };
  int width = 0, height = 0;
  std::vector<Run> runs;
  float nearest_mm = 0, step_mm = 0;
  std::vector<std::uint16_t> depth;    ///< steps beyond the nearest
  std::vector<std::uint8_t> sigma;     ///< sixteenths of an octave above 0.1 um
  std::vector<std::uint16_t> texture;  ///< of all pixels, or empty
  ShadeMap shade = {};

  [[nodiscard]] std::size_t bytes() const noexcept {
    return sizeof(*this) + runs.size() * sizeof(Run) + sigma.size() + shade.size() +
           (depth.size() + texture.size()) * sizeof(std::uint16_t);
  }
};

enum class Texture : std::uint8_t { kKept, kDropped };
[[nodiscard]] PackedPatch pack(const SurfacePatch& patch, Texture texture);

/// Makes patches of packed ones: points from the rays, normals from the depth. Immutable, thread-safe.
class Unpacker {
 public:
  Unpacker(std::shared_ptr<const RayDepth> rays, const NormalConfig& normals)
      : rays_(std::move(rays)), normals_(normals) {}

  /// modulation_dn stays empty, texture_dn too where it was dropped. Precondition: the patch was measured with these
  /// rays.
  [[nodiscard]] SurfacePatch operator()(const PackedPatch& packed) const;

 private:
  std::shared_ptr<const RayDepth> rays_;
  NormalConfig normals_;
};

}  // namespace enamel::pipeline
