// Inner corners of a chessboard.
#pragma once

#include <vector>

#include "calib/target/target.hpp"
#include "pipeline/types/map.hpp"

namespace enamel::calib {

struct BoardCorner {
  int index = 0;  ///< TargetDesign::index
  Eigen::Vector2d image_px{0, 0};
};

/// All inner corners, by rising index, at the saddle points of the grey levels. The window of the search is bounded by
/// a third of the smallest distance of two corners: a window that reaches the next corner pulls towards it. A
/// chessboard does not tell its two ends apart: the columns count to the right or down (du + dv > 0), so that a board
/// rolled by less than 45 degrees against 0 or 90 keeps its order over the poses. Errors: kTargetNotFound.
[[nodiscard]] Result<std::vector<BoardCorner>> find_chessboard(const Map<float>& image, const TargetDesign& target);

}  // namespace enamel::calib
