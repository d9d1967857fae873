// Values known at the nodes of a coarse grid over the image, bilinear between them, one image row at a time: a full map
// of them would cost more to write and read than to make.
#pragma once

#include "pipeline/decode/phase/row_memory.hpp"
#include "pipeline/types/map.hpp"

namespace enamel::pipeline {

/// Node (i, j) lies in the middle of the cell of cell_px that begins at (i, j) cell_px; values are held beyond the
/// outermost. nodes: row major, borrowed; null: 0 everywhere.
struct Grid {
  const float* nodes = nullptr;
  int columns = 0, rows = 0, cell_px = 1;
};

/// Columns first, first + step, ... of a row: first < step, which is 1 or 2 (then all cells are a multiple of 4 wide).
struct GridColumns {
  std::size_t first = 0, step = 1;
};

/// One caller's; rows are cheapest in order.
class GridRows {
 public:
  /// width: of the whole image.
  GridRows(const Grid& grid, int width, GridColumns columns = {});

  /// Values of those columns of image row v, valid until the next call.
  [[nodiscard]] const float* row(int v);

 private:
  void expand(int node_row, RowMemory& out) const;

  Grid grid_;
  GridColumns columns_;
  RowMemory low_, high_, out_;  ///< node rows above and below, spread over the image's width; their mean
  int low_row_ = -1, high_row_ = -1;
};

/// The whole map, which has its size already.
void interpolate_grid(const Grid& grid, Map<float>& out);

}  // namespace enamel::pipeline
