// Balls of a known diameter in one burst's surface: every point votes for the centre one radius below it along its
// normal; where votes meet, a ball is fitted and asked whether all that should be seen of it is there.
#pragma once

#include <vector>

#include "calib/model/rig.hpp"
#include "pipeline/types/patch.hpp"

namespace enamel::pipeline {

struct SphereConfig {
  int vote_stride_px = 4;
  double vote_mm = 0.25;         ///< votes of a ball fall within: 1.5 mm times the normals' noise, twice
  double min_vote_share = 0.25;  ///< of the votes that a whole ball gives
  double cap_deg = 50;           ///< of incidence: farther out the light is weak and neighbours cast shadows
  double first_gate_mm = 0.15;   ///< from votes good to a tenth of a mm …
  double gate_mm = 0.04;         ///< … to the fit; widened by noise
  double min_seen = 0.5;         ///< share of the cap that must be measured and lie on the ball …
  double min_agree = 0.85;       ///< … and of what is measured in the cap, the share that must lie on it
  double radius_mm = 0.01;       ///< the radius that fits best differs by less than this, and …
  double form_mm = 0.008;  ///< … rms of the surface about the ball beyond the noise: scanned spheres show 2 to 5 um
  int rounds = 8;
};

struct FoundSphere {
  double radius_mm = 0;                                  ///< that was fitted with
  Vec3d centre = Vec3d::Zero();                          ///< camera frame
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< mm^2; of noise, scaled by what the fit leaves
  Vec3d per_radius = Vec3d::Zero();                      ///< move of the centre for a mm of radius
  double radius_off_mm = 0;                              ///< of the radius that would fit best
  double rms_mm = 0;
  int points = 0;
};

/// Pure; in falling order of votes. The patch has the lens's size.
[[nodiscard]] std::vector<FoundSphere> find_spheres(const SurfacePatch& patch, const calib::LensValues& lens,
                                                    double radius_mm, const SphereConfig& config);

}  // namespace enamel::pipeline
