// Discs printed on a board: edges sharp to the last digit, which vertex albedos could not be.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

namespace enamel::twin {

/// Lattices of discs on a board that is nearly the plane z = 0; places count in x and y.
struct DotPrint {
  int cols = 0, rows = 0;
  double pitch_mm = 0, radius_mm = 0;
  std::vector<Eigen::Vector2d> offsets_mm;  ///< printed place minus design, one a dot, row by row
  std::vector<Eigen::Vector2d> middles_mm;  ///< of each lattice; one, or more boards in view
  std::vector<bool> is_ring{};              ///< row by row; empty: no dot has a hole
  double ring_inner_mm = 0;                 ///< radius of the hole, of the ground's colour
  float dot_albedo = 0, ground_albedo = 0;

  [[nodiscard]] float albedo(const Eigen::Vector3d& point) const {
    for (const Eigen::Vector2d& middle : middles_mm) {
      const Eigen::Vector2d p = point.head<2>() - middle;
      const Eigen::Vector2d first(-0.5 * (cols - 1) * pitch_mm, -0.5 * (rows - 1) * pitch_mm);
      const long col = std::lround((p.x() - first.x()) / pitch_mm), row = std::lround((p.y() - first.y()) / pitch_mm);
      if (col < 0 || row < 0 || col >= cols || row >= rows) continue;
      const Eigen::Vector2d design =
          first + pitch_mm * Eigen::Vector2d(static_cast<double>(col), static_cast<double>(row));
      const Eigen::Vector2d centre = design + offsets_mm[static_cast<std::size_t>(row * cols + col)];
      const double r2 = (p - centre).squaredNorm();
      const bool in_hole = !is_ring.empty() && is_ring[static_cast<std::size_t>(row * cols + col)] &&
                           r2 <= ring_inner_mm * ring_inner_mm;
      if (r2 <= radius_mm * radius_mm && !in_hole) return dot_albedo;
    }
    return ground_albedo;
  }
};

}  // namespace enamel::twin
