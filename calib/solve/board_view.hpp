// A chessboard's corners as dots of a pose: places in the camera, projector coordinates from the squares around them.
#pragma once

#include "calib/fringe/phase.hpp"
#include "calib/solve/observation.hpp"
#include "calib/target/chessboard.hpp"

namespace enamel::calib {

/// The ellipse of such a dot has its centre at the corner and no meaning beyond that. Samples lie within half a square
/// of the corner and off the edges, where blur mixes two albedos. A corner with fewer than 20 usable ones is left out.
[[nodiscard]] PoseView board_view(const std::string& name, const std::vector<BoardCorner>& corners,
                                  const TargetDesign& target, const CoordinateMap& u, const CoordinateMap& v);

}  // namespace enamel::calib
