#include "pipeline/decode/phase/misfit.hpp"

#include <algorithm>

#include "pipeline/decode/phase/poly_trig.hpp"

namespace enamel::pipeline {

void Misfit::start(int width, int height) {
  width_ = width, height_ = height;
  column_sums_.assign(kSums * static_cast<std::size_t>(width), 0.0F);
  cells_.clear();
}

void Misfit::take_row(int v, const MisfitRow& row) {
  constexpr float kMost = kMostMisfit * kMostMisfit;
  const auto width = static_cast<std::size_t>(width_);
  const float* __restrict of_row = row.squares, * __restrict of_noise = row.noise;
  float* __restrict squares = column_sums_.data() + kSquares * width;
  float* __restrict noise = column_sums_.data() + kNoise * width;
  float* __restrict pixels = column_sums_.data() + kPixels * width;
  for (std::size_t u = 0; u < width; ++u) {
    const float s = of_row[u], n = of_noise[u];
    const bool used = (n > 0) & (s * n < kMost);  // false for NaN
    squares[u] += select(used, s, 0);
    noise[u] += select(used, n, 0);
    pixels[u] += select(used, 1, 0);
  }
  if ((v + 1) % kMisfitCell_px == 0 || v + 1 == height_) finish_cells();
}

void Misfit::finish_cells() {
  const auto width = static_cast<std::size_t>(width_), cell = static_cast<std::size_t>(kMisfitCell_px);
  for (std::size_t u = 0; u < width; u += cell) {
    for (std::size_t k = 0; k < kSums; ++k) {
      const float* of_pixel = column_sums_.data() + k * width;
      float sum = 0;
      for (std::size_t i = u; i < std::min(u + cell, width); ++i) sum += of_pixel[i];
      cells_.push_back(sum);
    }
  }
  std::fill(column_sums_.begin(), column_sums_.end(), 0.0F);
}

/// What the mean of a cell exceeds noise by, less what noise alone reaches in one cell of six: a square of it has mean
/// 1 and variance 2.
float Misfit::excess(const float* cell) {
  const float pixels = cell[kPixels];
  if (!(pixels > 0)) return 0;
  return larger((cell[kSquares] - root(2 * pixels)) / pixels - 1, 0) * (cell[kNoise] / pixels);
}

void Misfit::add_to(Map<float>& sigma_rad, float phase_of_residual) {
  const float c2 = phase_of_residual * phase_of_residual;
  variance_.clear();
  for (std::size_t k = 0; k < cells_.size(); k += kSums) variance_.push_back(c2 * excess(&cells_[k]));
  const int columns = (width_ + kMisfitCell_px - 1) / kMisfitCell_px,
            rows_of_cells = (height_ + kMisfitCell_px - 1) / kMisfitCell_px;
  GridRows rows({variance_.data(), columns, rows_of_cells, kMisfitCell_px}, width_);
  for (int v = 0; v < height_; ++v) {
    const float* __restrict beyond = rows.row(v);
    float* __restrict sigma = &sigma_rad(0, v);
    for (std::size_t u = 0; u < static_cast<std::size_t>(width_); ++u) sigma[u] = root(sigma[u] * sigma[u] + beyond[u]);
  }
}

}  // namespace enamel::pipeline
