// Integer coordinates for points that lie on a projectively seen square lattice. Private to calib/target.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace enamel::calib {

struct LatticePoint {
  int point = 0;  ///< index into the points given
  int a = 0, b = 0;
};

/// The lattice that holds the point nearest to `start`: grown from neighbour to neighbour, then completed by a
/// homography. `taken` points are left out. Empty when no two axes can be told.
[[nodiscard]] std::vector<LatticePoint> grow_lattice(std::span<const Eigen::Vector2d> points,
                                                     const std::vector<bool>& taken, const Eigen::Vector2d& start);

}  // namespace enamel::calib
