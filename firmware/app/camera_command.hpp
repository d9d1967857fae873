// `enamel-probe --camera list`.
#pragma once

#include "protocol/base/result.hpp"

namespace enamel::fw {

/// Prints the cameras of this machine with their modes. 0, or 3 when there is none: why is printed. Errors: kCamera.
[[nodiscard]] Result<int> print_cameras(bool json);

}  // namespace enamel::fw
