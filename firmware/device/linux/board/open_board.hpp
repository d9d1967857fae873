// The board that a profile describes, with its real parts.
#pragma once

#include "firmware/device/linux/board/board_device.hpp"

namespace enamel::fw {

/// Errors: kBoardLine, kCamera, kProjector, kBoardTiming and those of the rig; the light is off then.
[[nodiscard]] Result<std::unique_ptr<Device>> open_board(const BoardProfile& profile, Clock& clock);

}  // namespace enamel::fw
