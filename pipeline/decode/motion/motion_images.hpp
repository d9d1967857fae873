// What slopes are measured in: 1/z and A of every second pixel of every second row. Private to pipeline/decode.
#pragma once

#include <cstddef>
#include <vector>

#include "pipeline/decode/motion/chosen.hpp"

namespace enamel::pipeline {

inline constexpr int kNode_px = 8;  ///< layout: of a grid of nodes over the image

/// Pixel (x, y) is that at (2x, 2y). The pixels of one row lie by their place x % 4 between nodes, so that those of
/// neighbouring nodes are neighbours.
class MotionImage {
 public:
  void resize(int width, int height);
  /// From every second pixel of an image row; y: half its number.
  void set_row(int y, const float* row);
  /// The pixels dx right of each node of a row, |dx| <= kReach, from node 0 on; a column further on for the next node.
  /// node_row's middle is y = 4 node_row + 2.
  [[nodiscard]] const float* around(int node_row, int dx, int dy) const noexcept {
    const int x = 2 + dx + 4;  // from the node before, so that it stays positive
    return row_of(4 * node_row + 2 + dy) + static_cast<std::ptrdiff_t>(x % 4) * pitch_ + x / 4 - 1;
  }

 private:
  [[nodiscard]] const float* row_of(int y) const noexcept {
    return data_.data() + static_cast<std::ptrdiff_t>(y) * 4 * pitch_;
  }
  int width_ = 0, height_ = 0;
  std::ptrdiff_t pitch_ = 0;
  std::vector<float> data_;
};

struct MotionImages {
  MotionImage inverse_depth;                 ///< NaN where rejected or out of range
  MotionImage light;                         ///< A - black at mid-burst
  std::vector<float> phase, row, light_row;  ///< scratch, of every second pixel of a row

  /// For an image of that size.
  void resize(int width, int height);
};

}  // namespace enamel::pipeline
