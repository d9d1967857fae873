// The probe process: puts the parts together, runs the control loop until the end.
#pragma once

#include <atomic>

#include "firmware/app/options.hpp"
#include "protocol/base/result.hpp"

namespace enamel::fw {

/// Returns the program's exit code. `stop` is set by a signal: light off, last status, end within a second.
[[nodiscard]] Result<int> run_probe(const ProbeOptions& options, const std::atomic<bool>& stop);

}  // namespace enamel::fw
