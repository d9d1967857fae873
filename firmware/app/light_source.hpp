// Chooses the source of simulated light.
#pragma once

#include <memory>

#include "firmware/app/options.hpp"
#include "firmware/sim/burst_source.hpp"

namespace enamel::fw {

/// Errors: kHal for --camera (no back end in this build), those of the twin and of the recording.
[[nodiscard]] Result<std::unique_ptr<BurstSource>> open_source(const ProbeOptions& options);

}  // namespace enamel::fw
