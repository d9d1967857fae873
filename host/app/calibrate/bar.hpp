// Part of `enamel calibrate check`: a two-sphere bar as a rig measures it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "calib/model/rig.hpp"
#include "protocol/base/result.hpp"

namespace enamel::app {

struct BarOptions {
  std::string capture;                   ///< recording or exchange folder that shows the bar
  std::vector<double> design_mm;         ///< both diameters, the smaller one first, and the distance of the centres
  std::vector<std::uint64_t> bursts{0};  ///< probe and bar at rest
};

/// Decodes the bursts with the rig's optics at the burst's temperature and the capture's own pattern set, and fits the
/// spheres: sizes, forms, distance with their standard errors, and the reasons against the calibration. Errors: those
/// of reading and decoding, kRigForeign for a capture of another probe, kUsage for a design that is not three lengths,
/// kQualityGate for a burst that is rejected, kCalibrationPoses when there are no two spheres.
[[nodiscard]] Result<nlohmann::ordered_json> check_bar(const calib::Rig& rig, const BarOptions& options);

}  // namespace enamel::app
