// A patch prepared for fusion: one tangent plane and one weight a pixel.
#pragma once

#include <cstdint>

#include "pipeline/algo/fuse/fuse_config.hpp"
#include "pipeline/types/map.hpp"
#include "pipeline/types/patch.hpp"

namespace enamel::algo {

/// Plane n . x = offset in camera coordinates (mm), n towards the camera.
struct Surfel {
  float nx = 0, ny = 0, nz = 0;
  float offset_mm = 0;
  float weight = 0;           ///< cos(incidence) * (sigma_ref / sigma)^2, capped; 0 = nothing to fuse here
  std::uint32_t support = 0;  ///< pixel measurements behind it, 1 … 9
};

/// Distances are taken to the pixel's tangent plane, so neither the pixel grid nor the slope biases them (the
/// projective distance times cos(incidence), extended below one pixel). The depth is averaged with those of its 3 x 3
/// neighbours that continue it within the noise: 84 um on the object, less than a voxel.
class SurfelMap {
 public:
  void build(const SurfacePatch& patch, const FuseConfig& config, FuseStats& stats);
  [[nodiscard]] int width() const noexcept { return surfels_.width(); }
  [[nodiscard]] int height() const noexcept { return surfels_.height(); }
  [[nodiscard]] const Surfel& operator[](std::size_t i) const noexcept { return surfels_[i]; }
  [[nodiscard]] const Surfel& operator()(int u, int v) const noexcept { return surfels_(u, v); }

 private:
  void average_rows(const SurfacePatch& patch);
  void average_columns(const SurfacePatch& patch);

  Map<Surfel> surfels_;
  Map<float> along_rows_mm_, smooth_mm_;
  Map<std::uint8_t> row_support_, support_;
};

}  // namespace enamel::algo
