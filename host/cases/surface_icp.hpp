// Point-to-plane ICP of one surface's elements on another surface, from where either stands. Private to host/cases.
#pragma once

#include <vector>

#include "host/cases/part_surface.hpp"
#include "pipeline/register/icp/normal_system.hpp"

namespace enamel::host {

struct SurfaceLayer {
  Vec3d middle = Vec3d::Zero();  ///< moving part's frame: what is farther from here …
  double radius_mm = 0;          ///< … than this does not take part
  double gate_mm = 0.15;         ///< largest distance of a match
  double max_normal_deg = 30;    ///< nor are normals that differ by more
  int rounds = 8;
};

/// One element and what it meets.
struct Pairing {
  enum Kind { kNone, kMet } kind = kNone;
  Vec3d point = Vec3d::Zero();   ///< fixed frame: the element …
  Vec3d normal = Vec3d::Zero();  ///< … and the normal that it meets
  double distance_mm = 0;        ///< along it, signed; across it, too, where that is more
};
/// kNone: nothing within reach, normals that differ too much, or a border.
[[nodiscard]] Pairing pair_up(const SurfaceElement& element, const PartSurface& fixed, const Pose& T_fixed_moving,
                              double within_mm, double max_normal_deg);

/// Moves T_fixed_moving. False where fewer than 30 elements meet. Deterministic.
bool lay_surface(const std::vector<SurfaceElement>& moving, const PartSurface& fixed, const SurfaceLayer& layer,
                 const pipeline::PriorConfig& prior, Pose& T_fixed_moving);

}  // namespace enamel::host
