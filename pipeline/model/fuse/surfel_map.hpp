// A patch prepared for fusion: one tangent plane and one weight a pixel.
#pragma once

#include <cstdint>
#include <vector>

#include "calib/model/rig.hpp"
#include "pipeline/model/fuse/fuse_config.hpp"
#include "pipeline/types/map.hpp"
#include "pipeline/types/patch.hpp"

namespace enamel::pipeline {

/// Plane n . x = offset in camera coordinates (mm), n towards the camera.
struct Surfel {
  float nx = 0, ny = 0, nz = 0;
  float offset_mm = 0;
  float weight = 0;           ///< cos(incidence) * (sigma_ref / sigma)^2, capped; 0 = nothing to fuse here
  std::uint32_t support = 0;  ///< pixel measurements behind it, 1 … 9
};

/// Distances are taken to the pixel's tangent plane, so neither the pixel grid nor the slope biases them (the
/// projective distance times cos(incidence), extended below one pixel). The depth is averaged with those of its 3 x 3
/// neighbours that continue it within the noise: 84 um on the object, less than a voxel. Surfel (i, j) is pixel (i, j)
/// * stride, with a stride of 2 where two pixels are still well below a voxel, else 1.
class SurfelMap {
 public:
  SurfelMap(const calib::Rig& rig, const FuseConfig& config);
  /// The patch's maps must have the camera's size.
  void build(const SurfacePatch& patch, const FuseConfig& config, FuseStats& stats);
  [[nodiscard]] int stride() const noexcept { return stride_; }
  [[nodiscard]] int width() const noexcept { return surfels_.width(); }
  [[nodiscard]] int height() const noexcept { return surfels_.height(); }
  [[nodiscard]] const Surfel& operator[](std::size_t i) const noexcept { return surfels_[i]; }
  [[nodiscard]] const Surfel& operator()(int i, int j) const noexcept { return surfels_(i, j); }

 private:
  void average_rows(const SurfacePatch& patch);
  void average_columns(const SurfacePatch& patch, int v);
  void gather_row(const SurfacePatch& patch, int v);
  void weigh_row(const FuseConfig& config, int j, FuseStats& stats);
  void scatter_row(const SurfacePatch& patch, int v);

  /// One row of surfels as contiguous floats: arithmetic on them vectorises.
  struct Line {
    std::vector<float> dot, z, sigma, per_depth, weight;
  };
  int stride_ = 1;
  Map<Surfel> surfels_;
  Map<float> along_rows_mm_, row_support_;  ///< of all rows of pixels, a surfel's column each
  std::vector<float> smooth_mm_, support_;  ///< of one row of surfels
  Line line_;
  Map<float> cos_to_axis_;  ///< of each surfel's ray
};

}  // namespace enamel::pipeline
