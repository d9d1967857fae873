// The rig that bursts are measured with when a calibration other than the probe's own is in force.
#pragma once

#include "calib/model/rig.hpp"

namespace enamel::calib {

/// Optics and depth range of `calibration`; patterns, sensor and crc32 (which the bursts name) of `device`. Errors:
/// kRigForeign when both state a serial and they differ; kRigInvalid when images or projector differ in size. Pure.
[[nodiscard]] Result<Rig> measuring_rig(const Rig& calibration, const Rig& device);

}  // namespace enamel::calib
