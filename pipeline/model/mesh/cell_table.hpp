// Marching cubes (Lorensen & Cline 1987): triangles of the 256 sign patterns of a cell, built from one rule instead of
// copied.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace enamel::pipeline {

/// Corner c of a cell lies at (c & 1, (c >> 1) & 1, c >> 2). Edge e runs along axis e / 4 from corner kCellEdge[e][0]
/// to [1].
inline constexpr std::array<std::array<std::uint8_t, 2>, 12> kCellEdge{
    {{0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3}, {4, 6}, {5, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}};

using CellTriangles = std::vector<std::array<std::uint8_t, 3>>;  ///< edges, counter-clockwise seen from outside

/// Element m: triangles of the cell whose corner c is inside (negative) where bit c of m is set. On a face with two
/// inside corners across a diagonal these are kept apart; the rule sees only that face, so both cells at it agree and
/// the surface is closed. Loops are cut along diagonals that do not lie in a face (else two cells could share a
/// diagonal).
[[nodiscard]] const std::array<CellTriangles, 256>& cell_table();

}  // namespace enamel::pipeline
