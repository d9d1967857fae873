// Surface normals of an organised depth map: least-squares plane through antisymmetric pixel pairs. On a plane 1/z is
// exactly linear over the image, so the fit is made there and needs no iteration.
#pragma once

#include <vector>

#include "pipeline/decode/triangulate/ray_depth.hpp"
#include "pipeline/types/geometry.hpp"
#include "pipeline/types/map.hpp"

namespace enamel::pipeline {

struct NormalConfig {
  /// chosen: by judgement, as LinkConfig::max_slope_deg. A steeper step between two pixels is a depth edge: the pair is
  /// left out.
  float max_slope_deg = 75;
};

/// Normals of a map that is made row by row, each row solved as soon as those that it looks at are there: they are
/// still in the processor's caches. One caller's; `memory` is kept between uses, and `rays` must live as long.
class NormalRows {
 public:
  NormalRows(const RayDepth& rays, const NormalConfig& config, std::vector<float>& memory);

  /// Where 1/z of image row v is to be written, NaN = none; rows come in order, from 0 to the last.
  [[nodiscard]] float* row(int v);

  /// Row v of 1/z and of sigma_mm is there: fills the normals of all rows that now can be known.
  void added(int v, const Map<float>& sigma_mm, Map<Vec3f>& normals);

 private:
  [[nodiscard]] bool spans_a_plane() const noexcept;  ///< a line of pixels does not
  void solve(int v, const float* sigma_mm, Map<Vec3f>& normals);

  const RayDepth& rays_;
  std::vector<float>&
      memory_;  ///< the last seven rows in a frame of NaN, so that loops need no borders; a row of normals
  std::size_t pitch_;
  float per_px_x_ = 0, per_px_y_ = 0, max_slope_;
};

/// inverse_depth: 1/z, NaN = none. sigma_mm: of the depth. normals: unit, towards the camera; NaN where fewer than two
/// independent pairs lie on one surface. Pure; `scratch` keeps its memory between calls.
void compute_normals(const RayDepth& rays, const Map<float>& inverse_depth, const Map<float>& sigma_mm,
                     const NormalConfig& config, std::vector<float>& scratch, Map<Vec3f>& normals);

}  // namespace enamel::pipeline
