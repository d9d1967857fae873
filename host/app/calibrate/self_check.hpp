// Part of `enamel calibrate check`: whether a scan contradicts the rig that measures it. No target is needed.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "calib/model/rig.hpp"
#include "protocol/base/result.hpp"

namespace enamel::app {

struct SelfCheckOptions {
  std::string capture;  ///< recording, exchange folder or session folder of a scan
  int views = 150;      ///< bursts that take part at most, evenly spread over the scan
  int workers = 2;
};

/// Replays the scan with the rig's optics at the bursts' temperature, takes bursts spread over it and adjusts their
/// poses together with the rig's drift: every figure with its standard error, the smallest drift that this scan would
/// have shown, "verdict" ok | alarm | unclear, and what to do. Errors: those of reading, kRigForeign for a scan of
/// another probe, kCalibrationPoses for one too short or without overlap.
[[nodiscard]] Result<nlohmann::ordered_json> self_check(const calib::Rig& rig, const SelfCheckOptions& options);

}  // namespace enamel::app
