// `enamel-probe projector info|load|test`.
#pragma once

#include <atomic>

#include "protocol/base/result.hpp"

namespace enamel::fw {

/// Arguments from "projector" on. 0 when done or --help was printed. Errors: kUsage, those of the projector and the
/// rig; the light is off then. `stop` ends a test at once.
[[nodiscard]] Result<int> run_projector(int argc, const char* const* argv, const std::atomic<bool>& stop);

}  // namespace enamel::fw
