// Test bodies with dimensions known exactly. Model z points to the probe, coordinates in mm.
#pragma once

#include <vector>

#include "tools/twin/surface/tri_surface.hpp"

namespace enamel::twin {

/// Plane z = 0, |x|, |y| <= half_mm, as a regular grid (the grid carries texture; all of it is coplanar).
struct PlaneConfig {
  double half_mm = 40;
  double strip_mm = 0;  ///< strips along x, as wide as each other, of its material and of plaster in turn; 0: none
  double grid_mm = 0.25;
};

/// Two or more balls on a rod along x, tops towards z.
struct SpheresConfig {
  std::vector<double> diameters_mm{5.0, 6.0};
  double pitch_mm = 8.0;         ///< centre to centre
  double rod_diameter_mm = 1.6;  ///< 0: none
};

/// Staircase along x: treads of tread_mm, rises in turn, and slots of slot_widths_mm cut into an own block beside it.
struct StepsConfig {
  std::vector<double> rises_mm{0.3, 1.0, 2.0, 3.3, -6.0};
  double tread_mm = 3.0;
  double width_mm = 12.0;  ///< along y
  std::vector<double> slot_widths_mm{0.3, 0.5, 1.0};
  double slot_depth_mm = 4.0;
};

inline constexpr float kPlasterAlbedo = 0.8F;

[[nodiscard]] Surroundings make_plane(const PlaneConfig& config);
[[nodiscard]] Surroundings make_spheres(const SpheresConfig& config);
[[nodiscard]] Surroundings make_steps(const StepsConfig& config);

}  // namespace enamel::twin
