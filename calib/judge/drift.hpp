// Self-check of a calibration from a scan, without a target: where views overlap that look from different sides, a
// drifted rig contradicts itself. Poses of all views and the drift are adjusted together (the same surface must come
// out of every view), so that what registration absorbs does not count.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "calib/judge/overlap.hpp"
#include "protocol/base/result.hpp"

namespace enamel::calib {

/// One way a rig drifts, as a height over the field at 48 mm: over 16 mm for bends, at 8 mm from the middle for tilts.
struct DriftFigure {
  const char* name = "";
  double um = 0, sigma_um = 0;  ///< sigma: jackknife over stretches of the scan
  double limit_um = 0;          ///< what it may be without harm
  double smallest_um = 0;       ///< that this scan would have raised an alarm at
  bool is_alarm = false;
};

struct DriftCheck {
  std::array<DriftFigure, kDriftModes> figures;
  DriftVector theta = DriftVector::Zero();
  double rms_before_um = 0, rms_after_um = 0;  ///< of the overlaps, poses adjusted: without and with the drift
  std::size_t views = 0, pairs = 0, matches = 0;
  [[nodiscard]] bool is_alarm() const;
  /// A figure whose smallest drift seen is more than ten limits: the scan says nothing about it.
  [[nodiscard]] std::vector<std::string> blind() const;
};

struct DriftConfig {
  OverlapConfig overlap;
  /// max_distance_mm once the poses have settled. What lies farther apart is no drift but an edge or a motion inside a
  /// burst: such matches are few, but with the wide kernel the standard errors are twice as large.
  double fine_distance_mm = 0.05;
  std::size_t min_matches = 100;  ///< a pair with fewer is none
  int stretches = 10;             ///< of the jackknife
  int iterations = 4;
  /// An alarm is beyond its limit and beyond so many standard errors. Ten stretches leave a standard error nine degrees
  /// of freedom: Student's t puts one true rig in 250 beyond 5 with any of the six figures, one in 50 beyond 4.
  double sigmas = 5;
};

/// Deterministic. Error: kCalibrationPoses when fewer than two views a stretch, or too few pairs that overlap.
[[nodiscard]] Result<DriftCheck> check_drift(std::vector<DriftView> views, const LensValues& camera,
                                             const DriftConfig& config = {});

}  // namespace enamel::calib
