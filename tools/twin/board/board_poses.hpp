// Where a board is shown to the probe for calibration.
#pragma once

#include <cstdint>
#include <vector>

#include "protocol/base/result.hpp"
#include "tools/twin/render/optics_model.hpp"
#include "tools/twin/surface/dot_board.hpp"

namespace enamel::twin {

/// T_model_cam of `count` stands drawn by the seed: depths spread over the rig's range (40 … 56 mm where it states
/// none), tilts of 15 to 35 degrees to all sides, a roll of a few degrees, every dot inside camera image and projector
/// frame. Error: kConfigValue when the board does not fit.
[[nodiscard]] Result<std::vector<Pose>> board_poses(const Instrument& instrument, const DotBoardConfig& board,
                                                    int count, std::uint64_t seed);

}  // namespace enamel::twin
