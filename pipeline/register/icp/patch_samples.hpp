// The points of a patch that registration may trust, thinned to a grid, with their weights.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/types/geometry.hpp"
#include "pipeline/types/patch.hpp"

namespace enamel::pipeline {

struct SampleConfig {
  int edge_px = 2;            ///< a sample needs valid neighbours at this distance on all four sides …
  double edge_pitches = 4.5;  ///< … whose depth differs by less than this many times their distance: no silhouettes
  double max_incidence_deg = 70;  ///< steeper surface is dropped: its triangulation and its weight are both poor
  /// Of soft tissue, which yields and moves, against teeth: so many of its samples are taken, by rows. Left out rather
  /// than weighed: what contradicts the model shall not count for a burst's consistency either. 1: all of them.
  double soft_weight = 0.2;
  std::uint8_t soft_below = kNothingSoft;  ///< shades below it are soft tissue's
  double sigma_floor_mm = 0.005;  ///< what calibration and motion leave on every point, added to sigma in squares
};

/// One resolution level. Camera frame, mm. weight = cos(incidence)/(sigma_z^2 + floor^2), mm^-2, > 0.
struct SampleSet {
  std::vector<float> x, y, z;     ///< one array a coordinate: the inner loop of ICP is worked four samples at a time
  std::vector<float> nx, ny, nz;  ///< unit normal
  std::vector<float> weights;
  Vec3d centroid = Vec3d::Zero();  ///< unweighted mean of the points
  double median_sigma_mm = 0;      ///< of sigma_z, by histogram (1 µm bins up to 0.25 mm)
  std::size_t offered = 0;         ///< with the samples on soft tissue that were left out
  [[nodiscard]] std::size_t size() const noexcept { return weights.size(); }
};

/// Samples every stride-th pixel in both directions, row by row. stride >= 1. Pure.
[[nodiscard]] SampleSet sample_patch(const SurfacePatch& patch, int stride, const SampleConfig& config);
/// The same with three strides, the last one the finest, into sets whose memory is used again.
void sample_levels(const SurfacePatch& patch, const std::array<int, 3>& strides, const SampleConfig& config,
                   std::array<SampleSet, 3>& out);

}  // namespace enamel::pipeline
