// The pattern set as a projector takes it: four 8-bit pictures and a description.
#pragma once

#include <string>

#include "calib/model/rig.hpp"
#include "protocol/base/result.hpp"

namespace enamel::calib {

/// Writes frame_0.png … frame_3.png, of the projector's size, and patterns.json into `folder`, which is created;
/// returns the text of patterns.json (mode, period, whether a response was undone, lowest and highest level and CRC-32
/// of each frame's pixels). Errors: kPatternSet in mode multi and where mean and amplitude leave 0…255; kFileWrite.
[[nodiscard]] Result<std::string> write_patterns(const Rig& rig, const std::string& folder);

}  // namespace enamel::calib
