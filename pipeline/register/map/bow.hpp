// A bow of the rig itself: what a wrong lens or a projector that was knocked adds to every patch alike.
// Triangulation reads a coordinate of the projector; where that is off, 1/z is off by an amount that depends on the
// direction of the camera's ray alone, and the point lies elsewhere on its ray. Constant and tilt of 1/z are projective
// (planes stay planes) and show nowhere; x^2, xy and y^2 bend a flat by the same height at every depth. The same model
// as the self-check's (docs/calibration.md): a bow found here is a bend found there. Pure, thread-safe.
#pragma once

#include <Eigen/Core>
#include <array>

#include "calib/model/rig.hpp"
#include "pipeline/types/geometry.hpp"
#include "pipeline/types/patch.hpp"

namespace enamel::pipeline {

inline constexpr int kBowTerms = 3;
inline constexpr std::array<const char*, kBowTerms> kBowNames{"x2", "xy", "y2"};
/// Of x^2, xy, y^2: how much deeper than it is a point is measured at the field's edge (xy: in its corner) in the
/// middle of the depth range, mm.
using BowVector = Eigen::Matrix<double, kBowTerms, 1>;
using BowMatrix = Eigen::Matrix<double, kBowTerms, kBowTerms>;
using BowShifts = Eigen::Matrix<double, 3, kBowTerms>;

/// The field that bows are told over.
class BowField {
 public:
  BowField() = default;
  explicit BowField(const calib::Rig& rig);

  /// Column m: how far a measured point is off for each mm of term m. Camera frame, p.z() > 0.
  [[nodiscard]] BowShifts shifts(const Vec3d& p) const;
  /// Depths, points and normals as they would have been measured without the bow.
  void take_out(const BowVector& bow, SurfacePatch& patch) const;

 private:
  [[nodiscard]] BowVector terms(double x, double y) const;  ///< homogeneous of second degree

  double inverse_half_x_ = 1, inverse_half_y_ = 1;  ///< of the field, of a ray (x, y, 1)
  double middle_mm_ = 1;
};

}  // namespace enamel::pipeline
