// What the poses taken so far cover of the field, the depth and the sides to lean to, and what is missing next.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "calib/guide/pose_check.hpp"

namespace enamel::calib {

struct CoverageWanted {
  int poses = 10;
  int per_third = 2;    ///< poses in the near, middle and far third of the depth range
  int per_side = 1;     ///< poses that lean to each of four sides
  double field = 0.85;  ///< share of the image's cells that held a dot
};

struct Coverage {
  static constexpr int kColumns = 8, kRows = 6;  ///< cells of the image
  int poses = 0;
  std::array<int, 3> by_depth{};  ///< near, middle, far
  std::array<int, 4> by_side{};   ///< right, down, left, up
  std::array<int, kColumns * kRows> dots_in_cell{};
  double field_share = 0;
  std::vector<std::string> missing;  ///< for a person, the most useful first; empty: enough
  [[nodiscard]] bool is_enough() const { return missing.empty(); }
};

/// Depth thirds refer to the rig's range less the reach of a tilted target at either end (an eighth of it); without a
/// range depth is not judged.
[[nodiscard]] Coverage coverage_of(const std::vector<SeenPose>& poses, const Rig& nominal,
                                   const CoverageWanted& wanted);

}  // namespace enamel::calib
