// rig.json to values, private to calib/model. Strict: every number finite, every key of its type, nothing half read.
#pragma once

#include <string_view>

#include "calib/model/rig.hpp"

namespace enamel::calib {

/// All fields of Rig but `text` and `crc32`. Error: kRigInvalid, the detail names the key.
[[nodiscard]] Result<Rig> read_rig_json(std::string_view text);

}  // namespace enamel::calib
