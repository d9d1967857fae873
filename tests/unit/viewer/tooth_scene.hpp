// A made-up quadrant for viewer tests: a height field of seven teeth on a gum ridge, cut into blocks that appear along
// a scan path. Only a picture's subject; nothing here measures anything.
#pragma once

#include <memory>
#include <vector>

#include "pipeline/types/preview.hpp"

namespace enamel::view::test {

struct ToothScene {
  double step_mm = 0.25;  ///< grid of the height field
  double block_mm = 4.0;
  int live_width = 320;
  int live_height = 240;

  /// Frame `i` of `n` (0-based): the path has come i / (n - 1) of the way. Blocks that did not change are shared with
  /// `previous`.
  [[nodiscard]] std::shared_ptr<PreviewFrame> frame(int i, int n, const PreviewFrame* previous = nullptr) const;

  [[nodiscard]] Pose pose(double share) const;
  [[nodiscard]] std::shared_ptr<const ModelSnapshot> model(double share, std::uint64_t burst,
                                                           const ModelSnapshot* previous) const;
  [[nodiscard]] std::shared_ptr<const Map<std::uint8_t>> live_image(const Pose& T_model_cam) const;
};

/// The same model with every second block soft tissue.
[[nodiscard]] std::shared_ptr<const ModelSnapshot> half_soft(const ModelSnapshot& model);

}  // namespace enamel::view::test
