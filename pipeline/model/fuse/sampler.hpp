// Trilinear interpolation of the distance field and its gradient.
#pragma once

#include "pipeline/model/fuse/block_grid.hpp"
#include "pipeline/types/geometry.hpp"

namespace enamel::pipeline {

/// Positions are in voxels (model coordinates / voxel_mm). Remembers the last block: neighbouring queries are cheap.
/// Not thread-safe; make one a thread.
class Sampler {
 public:
  explicit Sampler(const BlockGrid& grid) : grid_(grid) {}

  /// Interpolated distance (mm) and the gradient of the interpolant (mm a voxel). False where one of the eight voxels
  /// is unobserved.
  bool sample(const Vec3d& at, float& distance_mm, Vec3f& gradient);

  /// By how much (mm) the interpolant lies above a field with the curvature of the voxels around: t (1 - t)/2 times the
  /// second difference, summed over the axes. Axes along which a neighbour is unobserved add nothing.
  float excess_mm(const Vec3d& at);

 private:
  struct Cell {
    std::array<int, 3> local{};   ///< lower corner within the block, 0 … 7
    std::array<float, 3> part{};  ///< position between lower and upper corner, 0 … 1
  };
  bool locate(const Vec3d& at, Cell& cell);
  bool corners(const Cell& cell, std::array<float, 8>& value) const;
  /// Voxel at an offset from the current block's first voxel, each -8 … 15. False if unobserved.
  bool voxel(int x, int y, int z, float& value) const;

  const BlockGrid& grid_;
  const Block* block_ = nullptr;
  std::uint64_t key_ = ~std::uint64_t{0};  ///< of the block last looked up
};

}  // namespace enamel::pipeline
