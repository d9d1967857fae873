// A solved rig as rig.json (format rig/1, schema 1).
#pragma once

#include <string>
#include <vector>

#include "calib/io/response.hpp"
#include "calib/model/light_inside.hpp"
#include "calib/model/rig.hpp"
#include "pipeline/types/geometry.hpp"

namespace enamel::calib {

struct SolvedRig {
  LensValues camera, projector;
  Pose T_proj_cam = Pose::Identity();
  std::vector<std::string> parameter_names;     ///< of the covariance's rows
  Eigen::MatrixXd covariance;                   ///< px, rad, mm by parameter
  std::string calibrated_at;                    ///< UTC, e.g. 2026-01-31T12:00:00Z
  std::optional<ProjectorResponse> response;    ///< where the folder has pictures of it
  std::optional<CorrectionField> correction;    ///< where one earned its place
  std::optional<double> temp_c = std::nullopt;  ///< of the probe while the pictures were taken; empty: as the set says
  std::optional<TemperatureTerms> temperature = std::nullopt;
  double rms_camera_px = 0, rms_projector_px = 0;
  int poses = 0;
  bool is_shape_solved = false;  ///< of the target: its scale is then held by the mean pitch alone
};

/// The nominal file with its optics replaced and what a solved rig adds; keys that nobody knows are kept, `nominal` is
/// dropped. `sha256` is that of the text with this value empty. Error: kRigInvalid when the text would not read back
/// as a rig (a value is not finite).
[[nodiscard]] Result<std::string> solved_rig_text(const Rig& nominal, const SolvedRig& solved);

/// The file of `rig` with that section, in place of an older one, sealed anew where it was sealed. Error: kRigInvalid
/// when the text would not read back.
[[nodiscard]] Result<std::string> with_light_inside(const Rig& rig, const LightInside& light);

/// Whether the file's `sha256` fits its content; true for files that carry none.
[[nodiscard]] bool is_rig_intact(const std::string& text);

/// Time of the newest image of the folder's poses, UTC: when the calibration was taken. Empty when there are none.
[[nodiscard]] std::string capture_time_utc(const std::string& folder);

}  // namespace enamel::calib
