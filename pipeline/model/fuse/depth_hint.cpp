#include "pipeline/model/fuse/depth_hint.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace enamel::pipeline {
namespace {

constexpr int kCell = 16;
constexpr int kGrowth = 3;
constexpr int kSampling = 4;  ///< pixels between the depths that a cell averages
constexpr float kNoDepth = std::numeric_limits<float>::quiet_NaN();

struct Mean {
  float sum = 0.0F;
  float count = 0.0F;
  void add(float value) {
    if (!std::isnan(value)) {
      sum += value;
      count += 1.0F;
    }
  }
  [[nodiscard]] float value() const { return count > 0.0F ? sum / count : kNoDepth; }
};

}  // namespace

void CoarseDepth::build(const Map<float>& depth_mm) {
  const int width = (depth_mm.width() + kCell - 1) / kCell, height = (depth_mm.height() + kCell - 1) / kCell;
  if (cells_.width() != width || cells_.height() != height) cells_ = Map<float>(width, height);
  for (int j = 0; j < cells_.height(); ++j) {
    for (int i = 0; i < cells_.width(); ++i) {
      Mean mean;
      for (int v = j * kCell; v < std::min((j + 1) * kCell, depth_mm.height()); v += kSampling) {
        for (int u = i * kCell; u < std::min((i + 1) * kCell, depth_mm.width()); u += kSampling) {
          mean.add(depth_mm(u, v));
        }
      }
      cells_(i, j) = mean.value();
    }
  }
  for (int k = 0; k < kGrowth; ++k) {
    grow();
  }
}

void CoarseDepth::grow() {
  before_ = cells_;
  const Map<float>& old = before_;
  for (int j = 0; j < old.height(); ++j) {
    for (int i = 0; i < old.width(); ++i) {
      if (!std::isnan(old(i, j))) {
        continue;
      }
      Mean mean;
      for (int y = std::max(0, j - 1); y <= std::min(old.height() - 1, j + 1); ++y) {
        for (int x = std::max(0, i - 1); x <= std::min(old.width() - 1, i + 1); ++x) {
          mean.add(old(x, y));
        }
      }
      cells_(i, j) = mean.value();
    }
  }
}

float CoarseDepth::near_pixel(int u, int v) const {
  const int i = u / kCell;
  const int j = v / kCell;
  return u >= 0 && v >= 0 && cells_.contains(i, j) ? cells_(i, j) : kNoDepth;
}

}  // namespace enamel::pipeline
