// Least squares over blocks of an image, whose unknowns have a spread of their own. Private to pipeline/decode.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace enamel::pipeline {

/// Sums over square blocks of an image of what rows add to every column, first in float over a block's rows.
template <std::size_t kSums>
class BlockSums {
 public:
  /// sums: of block k, row major, [k * kSums + s].
  BlockSums(int width, int height, int block_px, std::vector<float>& column_sums, std::vector<double>& sums)
      : width_(static_cast<std::size_t>(width)),
        block_px_(static_cast<std::size_t>(block_px)),
        across_((width_ + block_px_ - 1) / block_px_),
        columns_(column_sums),
        sums_(sums) {
    columns_.assign(kSums * width_, 0.0F);
    sums_.assign(across_ * ((static_cast<std::size_t>(height) + block_px_ - 1) / block_px_) * kSums, 0.0);
  }

  [[nodiscard]] std::size_t width() const noexcept { return width_; }

  /// Where row v adds its sum s of column u: at [s * width + u]. Rows come in order.
  [[nodiscard]] float* columns_of(int v) {
    const std::size_t row = static_cast<std::size_t>(v) / block_px_;
    if (row != block_row_) finish();
    block_row_ = row;
    return columns_.data();
  }

  /// After the last row.
  void finish() {
    double* out = &sums_[block_row_ * across_ * kSums];
    for (std::size_t s = 0; s < kSums; ++s) {
      const float* column = &columns_[s * width_];
      for (std::size_t k = 0; k < across_; ++k) {
        double sum = 0;
        for (std::size_t u = k * block_px_; u < std::min(width_, (k + 1) * block_px_); ++u)
          sum += static_cast<double>(column[u]);
        out[k * kSums + s] += sum;
      }
    }
    std::fill(columns_.begin(), columns_.end(), 0.0F);
  }

 private:
  std::size_t width_, block_px_, across_, block_row_ = 0;
  std::vector<float>& columns_;
  std::vector<double>& sums_;
};

/// Normal equations of kUnknowns unknowns.
template <std::size_t kUnknowns>
class BlockFit {
 public:
  /// layout: for each unknown its products with itself, with those after it and with the residual, all weighted by the
  /// inverse of the residual's variance; then the square of the residual; last, how many residuals.
  static constexpr std::size_t kSums = kUnknowns * (kUnknowns + 3) / 2 + 2;
  static constexpr int kSize = static_cast<int>(kUnknowns);
  using Matrix = Eigen::Matrix<double, kSize, kSize>;
  using Vector = Eigen::Matrix<double, kSize, 1>;
  using Spread = std::array<double, kUnknowns>;  ///< of each unknown about 0, before the block is seen

  struct Known {
    Vector x;
    Matrix covariance;
    [[nodiscard]] double sigma(Eigen::Index i) const { return std::sqrt(covariance(i, i)); }
  };

  BlockFit() = default;
  explicit BlockFit(const double* sums) {
    for (Eigen::Index i = 0; i < kSize; ++i) {
      for (Eigen::Index j = i; j < kSize; ++j) left_(i, j) = left_(j, i) = *sums++;
      right_[i] = *sums++;
    }
    squares_ = sums[0], count_ = sums[1];
  }

  BlockFit& operator+=(const BlockFit& o) {
    left_ += o.left_, right_ += o.right_, squares_ += o.squares_, count_ += o.count_;
    return *this;
  }

  [[nodiscard]] double count() const noexcept { return count_; }

  [[nodiscard]] Known solve(const Spread& spread) const {
    const Eigen::LDLT<Matrix> factors(held(spread));
    return {factors.solve(right_), factors.solve(Matrix::Identity())};
  }

  /// What the first unknowns explain beside all others, and what all leave: chi squared less what noise has of it.
  struct Told {
    double first = 0, left = 0;
    Told& operator+=(const Told& o) {
      first += o.first, left += o.left;
      return *this;
    }
  };
  template <int kFirst>
  [[nodiscard]] Told told_by_first(const Spread& spread) const {
    constexpr int kRest = kSize - kFirst;
    const Matrix left = held(spread);
    const Vector x = Eigen::LDLT<Matrix>(left).solve(right_);
    const Eigen::Matrix<double, kRest, kRest> of_rest = left.template bottomRightCorner<kRest, kRest>();
    const Eigen::Matrix<double, kRest, 1> right = right_.template tail<kRest>();
    const Eigen::Matrix<double, kRest, 1> y = Eigen::LDLT<Eigen::Matrix<double, kRest, kRest>>(of_rest).solve(right);
    const double by_all = right_.dot(x), by_rest = right.dot(y);
    return {by_all - by_rest - kFirst, squares_ - by_all - count_ + kSize};
  }

 private:
  [[nodiscard]] Matrix held(const Spread& spread) const {
    Matrix left = left_;
    left.diagonal() += Vector(spread.data()).cwiseAbs2().cwiseInverse();
    return left;
  }

  Matrix left_ = Matrix::Zero();
  Vector right_ = Vector::Zero();
  double squares_ = 0, count_ = 0;
};

}  // namespace enamel::pipeline
