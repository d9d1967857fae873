// How a pattern mode shows motion during the burst. Each has a residual y, which its frames leave once the orders are
// known: mode T the closure, mode M what its code frame shows beyond the prediction of the other three. All read
//   y = (column of eps) eps + (column of dA/A) dA/A + (shared column) x + noise
// where x is one number of the whole burst: the projector's second harmonic rho in mode T, the gain of the code frame
// beyond its blocks' in mode M.
#pragma once

#include <vector>

#include "pipeline/decode/motion/chosen.hpp"
#include "pipeline/decode/motion/motion_images.hpp"
#include "pipeline/decode/motion/motion_samples.hpp"
#include "pipeline/decode/phase/grid_rows.hpp"

namespace enamel::pipeline {

/// Motion at the nodes of a grid over the image, per frame interval.
struct MotionField {
  int columns = 0, rows = 0;
  int detail = 1;                                    ///< nodes of eps and dA/A per node of the others, along each axis
  std::vector<float> rate_rad, light;                ///< eps; dA/A
  std::vector<float> rate_change_rad, light_change;  ///< of eps; d2A/A
  float shared = 0;                                  ///< x

  /// Valid while this lives.
  [[nodiscard]] Grid rate_grid() const noexcept {
    return {rate_rad.data(), detail * columns, detail * rows, kNode_px / detail};
  }
  [[nodiscard]] Grid light_grid() const noexcept {
    return {light.data(), detail * columns, detail * rows, kNode_px / detail};
  }
  [[nodiscard]] Grid rate_change_grid() const noexcept { return {rate_change_rad.data(), columns, rows, kNode_px}; }
  [[nodiscard]] Grid light_change_grid() const noexcept { return {light_change.data(), columns, rows, kNode_px}; }
  [[nodiscard]] Grid shared_grid() const noexcept { return {&shared, 1, 1, kNode_px}; }
};

/// One burst's; not thread-safe.
class MotionView {
 public:
  MotionView() = default;
  MotionView(const MotionView&) = delete;
  MotionView& operator=(const MotionView&) = delete;
  virtual ~MotionView() = default;

  /// Residuals about the motion known so far; null: as the mode finds them without it.
  virtual void take_samples(const MotionField* known, MotionSamples& out) = 0;
  /// Depth and light as they are when the motion known so far is undone; null: that of the blocks.
  virtual void make_images(const MotionField* known, MotionImages& out) = 0;
  /// eps by the block that holds pixel (u, v) alone; NaN where it does not tell.
  [[nodiscard]] virtual float block_rate(int u, int v) const = 0;
};

}  // namespace enamel::pipeline
