// Points of the surface described in the surface's own frame, so that they look the same from every side: where bending
// is extreme, with a SIFT-like histogram of the normals around it, laid out on the tangent plane and weighed by area on
// the surface instead of by pixels. After Koeser & Koch 2007 (perspectively invariant normal features), Lowe 2004.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/register/feature/surface_grid.hpp"
#include "pipeline/types/geometry.hpp"
#include "pipeline/types/patch.hpp"

namespace enamel::pipeline {

/// One match of two of them gives a whole rigid motion.
struct SurfaceFeature {
  Vec3f point = Vec3f::Zero();                         ///< camera frame of its patch, mm
  Eigen::Matrix3f axes = Eigen::Matrix3f::Identity();  ///< columns: main direction, across it, normal; right-handed
  bool convex = true;                                  ///< a tip or a ridge; else a pit or a fissure
  std::array<std::uint8_t, 128> descriptor{};          ///< 4 x 4 cells, 8 directions of slope
};

struct SurfaceFeatureConfig {
  GridConfig grid;
  double bend_radius_mm = 0.45;   ///< chosen: bending is measured over this; half of what edges and fissures are wide
  double apart_mm = 0.35;         ///< derived: extrema nearer than about the radius of bending are one
  double min_bend_per_mm = 0.05;  ///< chosen: flatter than a ball of 20 mm is flat
  double half_width_mm = 1.2;  ///< chosen: of the square described. Larger ones reach round edges, over what one side
                               ///< does not see; smaller ones are alike everywhere
  double min_known = 0.6;      ///< chosen: share of the square's inscribed disc that must be seen
  double peak_ratio = 0.8;     ///< Lowe 2004: directions nearly as strong as the main one are described too
  int max_features = 300;      ///< the most bent
};

/// Deterministic, thread-safe. grid: make_surface_grid(…, config.grid) of the patch.
[[nodiscard]] std::vector<SurfaceFeature> extract_surface_features(const SurfaceGrid& grid,
                                                                   const SurfaceFeatureConfig& config);
[[nodiscard]] std::vector<SurfaceFeature> extract_surface_features(const SurfacePatch& patch, double px_per_mm,
                                                                   const SurfaceFeatureConfig& config);

}  // namespace enamel::pipeline
