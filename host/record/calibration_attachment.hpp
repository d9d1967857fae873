// A recording made with another calibration than the probe's own carries it: the header's rig stays what the probe
// said.
#pragma once

namespace enamel::host {

inline constexpr const char* kCalibrationAttachment = "calibration.json";               ///< rig.json in force
inline constexpr const char* kCalibrationReportAttachment = "calibration-report.json";  ///< of `calibrate solve --json`
inline constexpr const char* kRecordedAt = "recorded_at";  ///< metadata: UTC, when a live recording began

}  // namespace enamel::host
