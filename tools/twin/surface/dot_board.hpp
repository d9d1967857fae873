// A calibration board: a grid of discs on dark ground, as target.json describes it. Model z points to the probe,
// columns run along x, rows along y, the middle of the grid is the origin; mm.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/twin/surface/tri_surface.hpp"

namespace enamel::twin {

struct DotBoardConfig {
  int cols = 9, rows = 7;
  double pitch_mm = 1.6;
  double radius_mm = 0.3;
  double margin_mm = 2.0;            ///< from the outermost dots' centres to the board's edge
  double dot_error_um = 0;           ///< rms of the print's error per axis, drawn by the seed
  double bow_um = 0;                 ///< rise of the middle over the corners
  bool is_doubled = false;           ///< a second grid beside the first: what a careless hand may show
  std::vector<std::string> rings{};  ///< one string a row, a dot with 1 is a ring; empty: none. Then `coded_dots`
  double ring_inner_mm = 0;          ///< radius of a ring's hole
  double dot_albedo = 0.7, ground_albedo = 0.12;

  [[nodiscard]] double half_width_mm() const { return 0.5 * (cols - 1) * pitch_mm + margin_mm; }
  [[nodiscard]] double half_height_mm() const { return 0.5 * (rows - 1) * pitch_mm + margin_mm; }
};

[[nodiscard]] Surroundings make_dot_board(const DotBoardConfig& config, std::uint64_t seed);

/// target.json: the design, without the errors of this board; `circle_grid`, or `coded_dots` where dots are rings.
[[nodiscard]] std::string target_json(const DotBoardConfig& config);

}  // namespace enamel::twin
