// Running means over one fringe along a row: ripples of whole periods a fringe leave nothing in them.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <vector>

namespace enamel::pipeline {

/// Of N values a pixel, over the pixels of one row that were added within reach_px on both sides. Use: clear, add each
/// pixel once, close, then ask.
template <int N>
class FringeMeans {
 public:
  using Values = Eigen::Matrix<double, N, 1>;

  FringeMeans(int width, int reach_px) : reach_px_(reach_px), sums_(static_cast<std::size_t>(width) + 1) {}

  void clear() { std::fill(sums_.begin(), sums_.end(), Sum{}); }
  void add(int u, const Values& values) { sums_[static_cast<std::size_t>(u) + 1] = {values, 1}; }
  /// After the last add.
  void close() {
    for (std::size_t u = 1; u < sums_.size(); ++u) {
      sums_[u].values += sums_[u - 1].values;
      sums_[u].count += sums_[u - 1].count;
    }
  }
  /// Share of the fringe around pixel u whose pixels were added; 0 … 1.
  [[nodiscard]] double filled(int u) const { return count(u) / (2 * reach_px_ + 1); }
  /// 0 where none was.
  [[nodiscard]] Values at(int u) const {
    return (sums_[end(u)].values - sums_[begin(u)].values) / std::max(count(u), 1.0);
  }

 private:
  struct Sum {
    Values values = Values::Zero();
    double count = 0;
  };
  [[nodiscard]] std::size_t begin(int u) const { return static_cast<std::size_t>(std::max(u - reach_px_, 0)); }
  [[nodiscard]] std::size_t end(int u) const {
    return std::min(static_cast<std::size_t>(u + reach_px_) + 1, sums_.size() - 1);
  }
  [[nodiscard]] double count(int u) const { return sums_[end(u)].count - sums_[begin(u)].count; }

  int reach_px_;
  std::vector<Sum> sums_;
};

}  // namespace enamel::pipeline
