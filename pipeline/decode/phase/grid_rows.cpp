#include "pipeline/decode/phase/grid_rows.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/phase/grid_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

void mix_loop(const float* low, const float* high, float share, std::size_t width, float* row) {
  const float* __restrict a = low, * __restrict b = high;
  float* __restrict out = row;
  for (std::size_t u = 0; u < width; ++u) out[u] = a[u] + share * (b[u] - a[u]);
}

/// A ramp between the middles of two cells, `count` pixels from pixel `first` of it on, each `step` from the one
/// before.
[[gnu::always_inline]] inline void ramp(float from, float slope, std::size_t first, std::size_t step, std::size_t count,
                                        float* out) {
  for (std::size_t k = 0; k < count; ++k)
    out[k] = from + slope * (static_cast<float>(static_cast<int>(first + k * step)) + 0.5F);
}

/// Ramps of cells of a size known to the compiler, which makes vectors of them.
template <std::size_t kCell, std::size_t kStep>
void ramps(const float* nodes, std::size_t count, std::size_t first, std::size_t width, float* row) {
  // layout: of a ramp.
  constexpr std::size_t kPixels = kCell / kStep, kBefore = kCell / 2 / kStep;
  constexpr float kShare = 1.0F / static_cast<float>(static_cast<int>(kCell));
  const float* __restrict node = nodes;
  float* __restrict out = row;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t begin = k * kPixels + kBefore;
    const float slope = (node[k + 1] - node[k]) * kShare;
    if (begin + kPixels <= width) {
      ramp(node[k], slope, first, kStep, kPixels, out + begin);
    } else if (begin < width) {
      ramp(node[k], slope, first, kStep, width - begin, out + begin);
    }
  }
}

void expand_loop(const float* node, const Grid& grid, const GridColumns& columns, std::size_t width, float* out) {
  const std::size_t last = static_cast<std::size_t>(grid.columns) - 1, cell = static_cast<std::size_t>(grid.cell_px);
  const std::size_t step = columns.step, first = columns.first, before = cell / 2 / step, pixels = cell / step;
  std::fill(out, out + std::min(before, width), node[0]);
  const auto is = [&](std::size_t of_cell, std::size_t of_step) { return cell == of_cell && step == of_step; };
  if (is(4, 1)) {
    ramps<4, 1>(node, last, first, width, out);
  } else if (is(8, 1)) {
    ramps<8, 1>(node, last, first, width, out);
  } else if (is(32, 1)) {
    ramps<32, 1>(node, last, first, width, out);
  } else if (is(8, 2)) {
    ramps<8, 2>(node, last, first, width, out);
  } else if (is(32, 2)) {
    ramps<32, 2>(node, last, first, width, out);
  } else {
    const float share = 1.0F / static_cast<float>(grid.cell_px);
    for (std::size_t k = 0; k < last && k * pixels + before < width; ++k) {
      const std::size_t begin = k * pixels + before;
      ramp(node[k], (node[k + 1] - node[k]) * share, first, step, std::min(pixels, width - begin), out + begin);
    }
  }
  if (last * pixels + before < width) std::fill(out + last * pixels + before, out + width, node[last]);
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(mix_loop);
HWY_EXPORT(expand_loop);

GridRows::GridRows(const Grid& grid, int width, GridColumns columns)
    : grid_(grid),
      columns_(columns),
      out_((static_cast<std::size_t>(width) - columns.first + columns.step - 1) / columns.step, 0.0F) {
  if (grid_.nodes == nullptr) return;
  low_ = RowMemory(out_.size());
  high_ = RowMemory(out_.size());
}

const float* GridRows::row(int v) {
  if (grid_.nodes == nullptr) return out_.data();
  const float y = (static_cast<float>(v) + 0.5F) / static_cast<float>(grid_.cell_px) - 0.5F;
  const int low = std::clamp(static_cast<int>(std::floor(y)), 0, grid_.rows - 1);
  const int high = std::min(low + 1, grid_.rows - 1);
  if (low != low_row_ || high != high_row_) {
    if (low == high_row_) std::swap(low_, high_), std::swap(low_row_, high_row_);
    if (low != low_row_) expand(low, low_);
    expand(high, high_);
    low_row_ = low, high_row_ = high;
  }
  if (low == high) return high_.data();
  HWY_DYNAMIC_DISPATCH(mix_loop)
  (low_.data(), high_.data(), std::clamp(y - static_cast<float>(low), 0.0F, 1.0F), out_.size(), out_.data());
  return out_.data();
}

/// Ramps from each cell's middle to the next.
void GridRows::expand(int node_row, RowMemory& line) const {
  const float* node = grid_.nodes + static_cast<std::ptrdiff_t>(node_row) * grid_.columns;
  HWY_DYNAMIC_DISPATCH(expand_loop)(node, grid_, columns_, line.size(), line.data());
}

void interpolate_grid(const Grid& grid, Map<float>& out) {
  GridRows rows(grid, out.width());
  for (int v = 0; v < out.height(); ++v) std::copy_n(rows.row(v), out.width(), &out(0, v));
}

}  // namespace enamel::pipeline
#endif
