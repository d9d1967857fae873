// Where to look for the model along each ray: the depth of a patch and, in its holes, that of the surroundings.
#pragma once

#include "pipeline/types/map.hpp"

namespace enamel::pipeline {

/// Mean depth of 16 x 16 pixel cells, grown outwards into empty cells by three cells. NaN = nothing near.
class CoarseDepth {
 public:
  /// Memory is kept from one depth map to the next.
  void build(const Map<float>& depth_mm);
  /// Depth near camera pixel (u, v); NaN outside the image or far from any depth.
  [[nodiscard]] float near_pixel(int u, int v) const;

 private:
  void grow();

  Map<float> cells_, before_;
};

}  // namespace enamel::pipeline
