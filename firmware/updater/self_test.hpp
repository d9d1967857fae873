// Runs the command that tests camera, projector and link.
#pragma once

#include <chrono>
#include <string>

#include "protocol/base/clock.hpp"

namespace enamel::fw {

/// True when the shell command exits 0 before the limit; it is killed at the limit. `slot`: "A", "B" or "recovery", in
/// the command's environment as ENAMEL_SLOT.
[[nodiscard]] bool run_self_test(const std::string& command, const std::string& slot, Clock& clock,
                                 std::chrono::milliseconds limit) noexcept;

}  // namespace enamel::fw
