// What the controllers' drivers share: how they refuse, and how they wait.
#pragma once

#include <fmt/core.h>

#include <string>

#include "protocol/base/clock.hpp"
#include "protocol/base/result.hpp"

namespace enamel::fw {

[[nodiscard]] inline tl::unexpected<Error> projector_refused(const std::string& what) {
  return fail(ErrorCode::kProjector, "projector: " + what);
}

/// Asks `done`, a Result<bool>, every 5 ms until it says yes. Errors: its own; kProjector with `what` after `limit`.
template <class Done>
[[nodiscard]] Result<void> wait_until(Clock& clock, Nanoseconds limit, const char* what, const Done& done) {
  constexpr Nanoseconds kPoll{5'000'000};
  const HostTime end = clock.now() + limit;
  for (;;) {
    ENAMEL_TRY_ASSIGN(const bool is_done, done());
    if (is_done) return {};
    if (clock.now() >= end) {
      return projector_refused(fmt::format("{} after {:.1f} s", what, static_cast<double>(limit.count()) * 1e-9));
    }
    clock.sleep_for(kPoll);
  }
}

}  // namespace enamel::fw
