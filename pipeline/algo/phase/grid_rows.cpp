#include "pipeline/algo/phase/grid_rows.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/algo/phase/grid_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::algo::HWY_NAMESPACE {

void mix_loop(const float* low, const float* high, float share, std::size_t width, float* row) {
  const float* __restrict a = low, * __restrict b = high;
  float* __restrict out = row;
  for (std::size_t u = 0; u < width; ++u) out[u] = a[u] + share * (b[u] - a[u]);
}

}  // namespace enamel::algo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::algo {

HWY_EXPORT(mix_loop);

GridRows::GridRows(const Grid& grid, int width) : grid_(grid), out_(static_cast<std::size_t>(width), 0.0F) {
  if (grid_.nodes == nullptr) return;
  low_.resize(out_.size());
  high_.resize(out_.size());
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
void GridRows::expand(int node_row, std::vector<float>& line) const {
  const auto n = static_cast<std::size_t>(grid_.columns), cell = static_cast<std::size_t>(grid_.cell_px);
  const float* node = grid_.nodes + static_cast<std::size_t>(node_row) * n;
  const std::size_t half = cell / 2, last = n - 1, width = line.size();
  float* out = line.data();
  std::fill(out, out + std::min(half, width), node[0]);
  const float step = 1.0F / static_cast<float>(cell);
  for (std::size_t k = 0; k < last; ++k) {
    const std::size_t begin = k * cell + half;
    const std::size_t count = begin < width ? std::min(cell, width - begin) : 0;
    const float from = node[k], slope = (node[k + 1] - from) * step;
    for (std::size_t j = 0; j < count; ++j)
      out[begin + j] = from + slope * (static_cast<float>(static_cast<int>(j)) + 0.5F);
  }
  if (last * cell + half < width) std::fill(out + last * cell + half, out + width, node[last]);
}

void interpolate_grid(const Grid& grid, Map<float>& out) {
  GridRows rows(grid, out.width());
  for (int v = 0; v < out.height(); ++v) std::copy_n(rows.row(v), out.width(), &out(0, v));
}

}  // namespace enamel::algo
#endif
