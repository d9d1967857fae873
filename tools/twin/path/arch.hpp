// The dental arch as a plane curve: what the teeth stand on and the scan path follows.
// Jaw coordinates: x to the patient's right, y forward, z occlusal (towards the probe), mm.
#pragma once

#include <Eigen/Geometry>
#include <vector>

namespace enamel::twin {

struct ArchShape {
  double half_width_mm = 26;  ///< lateral distance of the second molar from the midline
  double depth_mm = 42;       ///< from the incisors back to there
  double exponent = 2.4;      ///< 2: parabola; larger: squarer front
};

/// y = -depth * |x / half_width|^exponent, by arc length s from the midline (s > 0 on x > 0), straight beyond its ends.
/// The y origin lies at the incisors.
class Arch {
 public:
  explicit Arch(const ArchShape& shape);
  [[nodiscard]] Eigen::Vector2d point(double s) const;
  [[nodiscard]] Eigen::Vector2d tangent(double s) const;  ///< unit, towards +s
  [[nodiscard]] Eigen::Vector2d buccal(double s) const;   ///< unit, outwards (to lips and cheek)

 private:
  std::vector<Eigen::Vector2d> points_;  ///< every kStepMm of arc length, s >= 0
};

}  // namespace enamel::twin
