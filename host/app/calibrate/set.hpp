// A calibration folder in the hands of `enamel calibrate`: measured poses, those held out, planes, and rigs from files.
#pragma once

#include <string>
#include <vector>

#include "calib/judge/plane_check.hpp"
#include "calib/solve/measure_folder.hpp"
#include "protocol/base/clock.hpp"

namespace enamel::app {

/// Of the rig, or that of the reference design with a warning where the rig states none.
[[nodiscard]] calib::DepthRange range_of(const calib::Rig& rig);

/// measure_folder with progress on stderr.
[[nodiscard]] Result<calib::MeasuredFolder> measure(const calib::CalibFolder& folder, const Clock& clock);

/// Moves the views of the named poses out of `measured`. Error: kUsage for a name that is no usable pose.
[[nodiscard]] Result<std::vector<calib::PoseView>> take_held_out(const std::vector<std::string>& names,
                                                                 calib::MeasuredFolder& measured);

/// Planes of the named poses by a rig; poses whose ground cannot be used are passed over with a warning.
[[nodiscard]] std::vector<calib::PlaneCheck> check_planes(const calib::CalibFolder& folder,
                                                          const std::vector<calib::PoseView>& views,
                                                          const calib::RigState& rig, const calib::Ripple& ripple);

/// Errors: those of load_rig; kRigInvalid when the file was changed after it was solved.
[[nodiscard]] Result<calib::Rig> load_intact(const std::string& path);

}  // namespace enamel::app
