// What moves with the probe and not with the surface: brightness that follows the projected fringes. Motion within a
// burst and the projector's response leave some of the fringes in its grey image; held against each other, two such
// pictures say that nothing moved.
#pragma once

#include "calib/model/rig.hpp"
#include "pipeline/types/geometry.hpp"
#include "pipeline/types/map.hpp"

namespace enamel::pipeline {

/// Phase of the projected fringes at a point of the surface. Immutable, thread-safe.
class FringePhase {
 public:
  explicit FringePhase(const calib::Rig& rig) : rig_(rig) {}
  /// p: camera frame, mm. Radians, not wrapped; NaN where p is or where the rig states no period.
  [[nodiscard]] double operator()(const Vec3f& p) const;

 private:
  calib::Rig rig_;
};

/// Takes what varies with cosine and sine of the phase and of its double out of `brightness`, fitted anew about every
/// `tile_px`. NaN in either map: unknown, left as it is. Maps of one size. Pure.
void remove_fringes(Map<float>& brightness, const Map<float>& phase, int tile_px);

}  // namespace enamel::pipeline
