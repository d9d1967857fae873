// The board that a profile describes, with its real parts.
#pragma once

#include "firmware/device/linux/board/board_device.hpp"

namespace enamel::fw {

/// Errors: kBoardLine, kCamera, kProjector, kBoardTiming and those of the rig; the light is off then.
[[nodiscard]] Result<std::unique_ptr<Device>> open_board(const BoardProfile& profile, Clock& clock,
                                                         const PartHandler& opened = {});

/// LED, gate, heater and projector off, each whatever becomes of the others: for when the program that held them was
/// killed. Errors: those of all parts that could not be reached, with the code of the first.
[[nodiscard]] Result<void> darken_board(const BoardProfile& profile, Clock& clock);

}  // namespace enamel::fw
