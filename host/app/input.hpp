// What the commands read: a recording, an exchange folder or a session folder, and the calibration that belongs to it.
#pragma once

#include <string>

#include "calib/model/rig.hpp"
#include "host/record/burst_stream.hpp"
#include "protocol/base/result.hpp"

namespace enamel::app {

/// The calibration in `rig_path` when given, else the one that the bursts carry. Errors: kRigMissing, those of
/// load_rig.
[[nodiscard]] Result<calib::Rig> rig_for(const std::string& rig_path, const host::BurstStream& stream,
                                         const std::string& input);

/// An attachment as text; empty when there is none.
[[nodiscard]] std::string attached_text(host::BurstStream& stream, const std::string& name);

}  // namespace enamel::app
