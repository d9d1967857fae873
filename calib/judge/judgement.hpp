// Whether a calibration is accepted, and why not.
#pragma once

#include <string>
#include <vector>

#include "calib/judge/plane_check.hpp"
#include "calib/judge/volume.hpp"
#include "calib/solve/solve.hpp"

namespace enamel::calib {

/// Limits of docs/calibration.md §7. A measured figure counts against its limit by what it exceeds it beyond
/// two standard errors.
struct JudgementLimits {
  double rms_camera_px = 0.04, rms_projector_px = 0.05;
  double p95_um = 1.5;      ///< what the covariance says of the volume, the scale apart
  double scale_ppm = 100;   ///< not for a target whose shape was solved: its pitch is known on average only
  double plane_rms_um = 3;  ///< of planes, beyond what the pixels' own scatter explains
  double bow_um = 0.5;      ///< |sag|, |twist| over 16 mm at any depth
};

struct Judgement {
  bool is_accepted = true;
  std::vector<std::string> reasons;
  VolumeDifference predicted;  ///< from the covariance: what to expect
  VolumeDifference bound;      ///< the same, exceeded by one calibration in a hundred (kBoundQuantile)
  std::vector<PlaneCheck> planes;
  bool are_planes_held_out = false;  ///< otherwise the planes took part in the solution and flatter it
  std::array<DepthShape, 3> shapes;
  double plane_rms_um = 0;          ///< over all planes
  double plane_noise_um = 0;        ///< the part of it that the pixels' scatter inside 5 x 5 blocks explains
  double plane_unexplained_um = 0;  ///< what is left: sqrt(rms² - noise²)
};

[[nodiscard]] Judgement judge(const Solution& solution, std::vector<PlaneCheck> planes, bool are_planes_held_out,
                              DepthRange range, const JudgementLimits& limits = {});

}  // namespace enamel::calib
