// target.json as the twin reads it: the grid of a board, and which of its dots are rings.
#pragma once

#include <string>

#include "protocol/base/result.hpp"
#include "tools/twin/surface/dot_board.hpp"

namespace enamel::twin {

/// Takes cols, rows, pitch_mm, radius_mm and, of `coded_dots`, ring_inner_mm and rings; what the file does not state
/// stays. `origin` stands for the file in messages. Error: kTargetFile with the key and what it must be.
[[nodiscard]] Result<void> parse_target(std::string_view text, const std::string& origin, DotBoardConfig& board);

/// Errors also: kFileNotFound, kFileRead.
[[nodiscard]] Result<void> read_target(const std::string& path, DotBoardConfig& board);

}  // namespace enamel::twin
