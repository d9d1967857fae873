// Asks the acquisition process that runs on this probe to test itself: what enamel-updated calls as its self-test.
#pragma once

#include <atomic>

#include "firmware/app/options.hpp"
#include "protocol/base/result.hpp"

namespace enamel::fw {

/// Waits for the process (it may still be starting), has it go through SELFTEST and returns 0 when it passed: camera
/// and projector answered, dark was dark, the tip's thermistor is sane, and the link carried it all. Ends after
/// options.seconds, 60 s unless given. Errors: kProbeNotFound, kProbeAmbiguous, kProbeRefused (a host holds it, it
/// scans or takes firmware), kProbeLost, kHal with the fault, kCancelled, kDds.
[[nodiscard]] Result<int> ask_self_test(const ProbeOptions& options, const std::atomic<bool>& stop);

}  // namespace enamel::fw
