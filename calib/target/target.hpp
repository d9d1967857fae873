// What target.json of a calibration folder says: the design of a flat target. Model frame: z = 0, x along the columns,
// y along the rows, origin in the middle of the grid, z towards the camera; mm.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/types/geometry.hpp"
#include "protocol/base/result.hpp"

namespace enamel::calib {

enum class TargetType { kCircleGrid, kChessboard, kCodedDots };

/// One feature of the grid; column and row from 0.
struct GridIndex {
  int col = 0, row = 0;
};

struct TargetDesign {
  TargetType type = TargetType::kCircleGrid;
  int cols = 0, rows = 0;  ///< dots, or inner corners of a chessboard
  double pitch_mm = 0;
  double radius_mm = 0;                  ///< of the dots; 0 for a chessboard
  bool is_white_on_dark = true;          ///< of the dots
  std::vector<GridIndex> marks = {};     ///< dots that are rings
  double ring_inner_mm = 0;              ///< of a coded board's rings: radius of the hole in the ground's colour
  std::vector<std::uint8_t> rings = {};  ///< of a coded board, row major: 1 a ring, 0 a dot; empty otherwise

  [[nodiscard]] int size() const noexcept { return cols * rows; }
  [[nodiscard]] int index(GridIndex g) const noexcept { return g.row * cols + g.col; }
  [[nodiscard]] GridIndex grid(int index) const noexcept { return {index % cols, index / cols}; }
  /// Design place of a feature, model frame, mm.
  [[nodiscard]] Vec3d place(int index) const noexcept {
    const GridIndex g = grid(index);
    return {(g.col - 0.5 * (cols - 1)) * pitch_mm, (g.row - 0.5 * (rows - 1)) * pitch_mm, 0.0};
  }
};

/// A coded board's map is checked: every window tells its place and its turn (code_map.hpp).
/// Error: kTargetFile, the detail names the key.
[[nodiscard]] Result<TargetDesign> parse_target(std::string_view text);

}  // namespace enamel::calib
