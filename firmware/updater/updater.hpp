// enamel-updated: from the flash to a probe that answers on USB.
#pragma once

#include <atomic>

#include "firmware/updater/options.hpp"
#include "protocol/base/result.hpp"

namespace enamel::fw {

/// Exit codes besides those of errors; whoever supervises starts the program again.
namespace updater_exit {
inline constexpr int kStopped = 0;
inline constexpr int kRestart = 10;
inline constexpr int kRestartRecovery = 11;
inline constexpr int kTrialFailed = 12;
}  // namespace updater_exit

/// Serves until `stop` or a restart is wanted; the exit code. A slot on trial is tested first and confirmed when it
/// passes. Errors: kFileNotFound, kFileWrite (scan lock), kFlash, kGadget.
[[nodiscard]] Result<int> run_updater(const UpdaterOptions& options, const std::atomic<bool>& stop);

}  // namespace enamel::fw
