// enamel-probe --check and --dark.
#pragma once

#include <atomic>

#include "firmware/app/options.hpp"

namespace enamel::fw {

/// Opens the device part by part, measures twenty bursts, prints what was found. 0 when all is good. Errors: that of
/// the first part that is not.
[[nodiscard]] Result<int> run_check(const ProbeOptions& options, const std::atomic<bool>& stop);

/// Switches a board's light and heater off, whoever left them on. Errors: those of the parts that cannot be reached.
[[nodiscard]] Result<int> run_dark(const ProbeOptions& options);

}  // namespace enamel::fw
