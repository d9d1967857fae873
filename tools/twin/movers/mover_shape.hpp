// Forms of bodies that move by themselves. SIMULATION: drawn to look about right to a scanner, not measured.
#pragma once

#include "tools/twin/movers/mover_config.hpp"
#include "tools/twin/surface/tri_surface.hpp"

namespace enamel::twin {

/// Own frame, mm: x along, y across, z towards the probe; the middle at the origin.
struct MoverForm {
  Vec3d half = Vec3d::Ones();  ///< half axes
  bool soft = false;           ///< changes its form from burst to burst
};
[[nodiscard]] MoverForm mover_form(MoverKind kind);

/// How far a soft body is bent and bulged just now, -1 … 1 each.
struct Bend {
  double along = 0, across = 0;
};

/// Closed surface, albedo and relief included. A rigid body's does not depend on the bend.
[[nodiscard]] TriSurface mover_mesh(const MoverConfig& config, const Bend& bend, std::uint64_t seed);

}  // namespace enamel::twin
