// Which calibration a run measures with, and what the report says of it.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "calib/model/rig.hpp"
#include "host/record/burst_stream.hpp"
#include "protocol/base/config.hpp"
#include "protocol/base/result.hpp"

namespace enamel::app {

/// Beyond these a calibration is marked, not refused: the scan may be all there is.
struct CalibrationLimits {
  double max_age_days = 365;
  double max_kelvins = 5;  ///< of a burst outside of what the calibration covers
};

/// Binds `[calibration]` of the configuration.
void bind(ConfigReader& reader, CalibrationLimits& limits);

/// What a calibration is used for.
struct CalibrationUse {
  std::string device_serial;                     ///< of the probe that made the bursts; may be empty
  std::string scanned_at;                        ///< UTC; empty when the recording does not say
  std::optional<std::array<double, 2>> burst_c;  ///< coldest and warmest burst
};

struct Calibration {
  calib::Rig rig;           ///< as its file says
  std::string report_json;  ///< of `calibrate solve --json`; empty when unknown
  std::string source;       ///< its path, or where else it came from
};

/// A rig file, and what its solver said of it where that lies beside it: X.report.json to X.json. Errors: those of
/// load_rig; kRigInvalid when the file was changed after it was solved.
[[nodiscard]] Result<Calibration> load_calibration(const std::string& path);

/// The one in `path` when given, else what the recording was measured with, else what the bursts carry. Errors:
/// kRigMissing, those of load_calibration.
[[nodiscard]] Result<Calibration> calibration_for(const std::string& path, host::BurstStream& stream,
                                                  const std::string& input);

/// The rig that measures bursts of `stream`. A calibration set's rig takes the pattern set of the bursts, and is
/// refused when it is of another serial; a whole rig replaces theirs and is marked (see calibration_json). Errors:
/// those of measuring_rig.
[[nodiscard]] Result<calib::Rig> rig_to_measure(const Calibration& calibration, const host::BurstStream& stream);

/// {"source", "sha256", "serial", "nominal", "foreign", "calibrated_at", "age_days", "temp_c", "kelvins_beyond",
/// "follows_temperature", "verdict", "expected_p95_um", "expected_p95_bound_um", "marks"}, those that are known.
/// `marks` says in words what speaks against it; each is logged as a warning too.
[[nodiscard]] std::string calibration_json(const Calibration& calibration, const CalibrationUse& use,
                                           const CalibrationLimits& limits);

}  // namespace enamel::app
