// A bar of two spheres as a length that no calibration knew: size, form and distance, each with its confidence.
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "pipeline/types/geometry.hpp"
#include "protocol/base/result.hpp"

namespace enamel::calib {

/// One measured point, camera coordinates.
struct BarPoint {
  int u = 0, v = 0;  ///< its pixel
  Vec3d place;
  double sigma_mm = 0;  ///< along the ray
};

struct SphereFit {
  Vec3d centre = Vec3d::Zero();
  double radius_mm = 0;
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();  ///< of centre and radius, mm², from the points' scatter
  std::size_t points = 0;
  double rms_um = 0;       ///< radial, single points
  double form_p95_um = 0;  ///< 95th percentile of the radial means over 5 x 5 pixels

  [[nodiscard]] double diameter_mm() const { return 2 * radius_mm; }
  [[nodiscard]] double diameter_sigma_mm() const { return 2 * std::sqrt(covariance(3, 3)); }
};

struct BarCheck {
  std::array<SphereFit, 2> spheres;  ///< the smaller one first
  double distance_mm = 0, distance_sigma_mm = 0;
};

/// Finds the two largest spheres of 1 to 6 mm radius and fits them to the points that are seen at less than 55 degrees
/// to their normal: beyond, a pixel's footprint reaches over the rim. Deterministic. Error: kCalibrationPoses when
/// there are no two.
[[nodiscard]] Result<BarCheck> check_bar(std::vector<BarPoint> points);

/// What is known of a bar.
struct BarDesign {
  double diameter_mm[2] = {0, 0};  ///< the smaller one first
  double distance_mm = 0;
};

/// Reasons against a calibration: a diameter or the distance off by more than 5 um beyond two standard errors, a form
/// of more than 15 um (docs/calibration.md §7).
[[nodiscard]] std::vector<std::string> judge_bar(const BarCheck& check, const BarDesign& design);

}  // namespace enamel::calib
