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

/// Depth and sigma of the valid pixels bit for bit, texture of all to 1/16 DN (0 … 4095): about a tenth of the maps.
struct PackedPatch {
  struct Run {
    std::uint32_t begin = 0, count = 0;  ///< pixels, row major
  };
  int width = 0, height = 0;
  std::vector<Run> runs;
  std::vector<float> depth_mm, sigma_mm;
  std::vector<std::uint16_t> texture;

  [[nodiscard]] std::size_t bytes() const noexcept {
    return sizeof(*this) + runs.size() * sizeof(Run) + (depth_mm.size() + sigma_mm.size()) * sizeof(float) +
           texture.size() * sizeof(std::uint16_t);
  }
};

[[nodiscard]] PackedPatch pack(const SurfacePatch& patch);

/// Makes patches of packed ones: points from the rays, normals from the depth. Immutable, thread-safe.
class Unpacker {
 public:
  Unpacker(std::shared_ptr<const RayDepth> rays, const NormalConfig& normals)
      : rays_(std::move(rays)), normals_(normals) {}

  /// modulation_dn stays empty. Precondition: the patch was measured with these rays.
  [[nodiscard]] SurfacePatch operator()(const PackedPatch& packed) const;

 private:
  std::shared_ptr<const RayDepth> rays_;
  NormalConfig normals_;
};

}  // namespace enamel::pipeline
