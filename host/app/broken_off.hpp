// A scan that a crash or a power cut broke off moments ago: the next one goes on with it by itself.
#pragma once

#include <optional>
#include <string>

namespace enamel::app {

/// Chosen: a machine is up again within minutes; a next patient is not yet in the chair.
constexpr double kGoesOnWithin_s = 300;

struct BrokenOff {
  std::string folder;  ///< of the session itself, where a link was asked for
  double age_s = 0;    ///< since its recording was last written; 0 where the clock was set back
};

/// The scan in `folder` (or behind that link), when its recording opens and has no end, and nobody writes into
/// it: neither a finished scan nor one under way.
[[nodiscard]] std::optional<BrokenOff> broken_off(const std::string& folder);

/// Whether a scan that is begun at `folder` goes on with what was broken off there. Says so, or how it could be gone
/// on with when that is too long ago.
[[nodiscard]] std::optional<BrokenOff> goes_on_with(const std::string& folder);

}  // namespace enamel::app
