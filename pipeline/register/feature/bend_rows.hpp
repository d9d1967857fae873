// The inner loop of bending(): a row of surface elements at a time. Private to register/feature.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "pipeline/register/feature/surface_grid.hpp"

namespace enamel::pipeline {

/// A SurfaceGrid with one array a coordinate, row-major.
struct GridPlanes {
  explicit GridPlanes(const SurfaceGrid& grid);
  std::vector<float> x, y, z, nx, ny, nz, area;
};

/// Sums over the neighbours of each element of a row.
struct BendRow {
  explicit BendRow(std::size_t width) : sum(width), sum2(width), seen(width) {}
  void clear() {
    for (auto* values : {&sum, &sum2, &seen}) std::ranges::fill(*values, 0.0F);
  }
  std::vector<float> sum;   ///< a (q-p).(n_q-n_p)
  std::vector<float> sum2;  ///< a |q-p|^2
  std::vector<float> seen;  ///< a
};

/// Adds to each element of `row`, the first of which is grid element `first`, what one neighbour says that is nearer
/// than radius; the neighbour of the first is `neighbour`.
void add_bends(const GridPlanes& grid, std::size_t first, std::size_t neighbour, float radius2, BendRow& row);

}  // namespace enamel::pipeline
