// A plaster plate in the form of a ring, bumps all over it, with a bar of two balls across: what a turning table is
// checked with. The bumps tie picture to picture on the way from one ball to the other. Model z points to the probe.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "tools/twin/surface/tri_surface.hpp"

namespace enamel::twin {

struct RingPlateConfig {
  double inner_mm = 15, outer_mm = 39;       ///< radii; the upper side is z = 0
  int bumps = 260;                           ///< balls sunk into the plate, by the seed
  std::array<double, 2> bump_mm{2, 5};       ///< least and largest diameter of a bump
  std::array<double, 2> diameters_mm{8, 7};  ///< of the bar's balls, at x < 0 and x > 0
  double distance_mm = 54;                   ///< from centre to centre, along x about the middle
  double height_mm = 5;                      ///< of their centres
  double rod_diameter_mm = 3;                ///< 0: none
  double sigma_um = 2.5;                     ///< standard deviation of the certified distance, drawn by the seed
};

struct RingPlate {
  Surroundings surroundings;     ///< balls: the bar's two, then the bumps
  std::string certificate_json;  ///< of the bar
};

/// Precondition: inner_mm < outer_mm.
[[nodiscard]] RingPlate make_ring_plate(const RingPlateConfig& config, std::uint64_t seed);

}  // namespace enamel::twin
