// Where the stops of a desktop scan come from: a recording, or a table that moves.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/desktop/desktop_model.hpp"
#include "host/desktop/stop_bursts.hpp"
#include "host/desktop/stop_plan.hpp"
#include "host/report/accounting.hpp"
#include "protocol/base/result.hpp"

namespace enamel::host {

/// next() from one thread; progress() and stop() from any.
class StopSource {
 public:
  StopSource() = default;
  StopSource(const StopSource&) = delete;
  StopSource& operator=(const StopSource&) = delete;
  virtual ~StopSource() = default;

  /// The next stop; nullopt after the last. `so_far`: for those who choose it by what is missing. An error ends the
  /// scan; what was taken before is kept.
  [[nodiscard]] virtual Result<std::optional<StopBursts>> next(const DesktopModel& so_far) = 0;
  /// No more stops; a call of next() that waits comes back soon.
  virtual void stop() = 0;
  virtual void set_paused(bool paused) = 0;

  /// Of the bursts that were not handed over: captured, lost, incomplete, shed; accepted ones too.
  [[nodiscard]] virtual BurstCounts counts() const = 0;
  /// How the plan ended; nullopt where stops come from a recording, which does not say.
  [[nodiscard]] virtual std::optional<PlanOutcome> plan() const { return std::nullopt; }
  /// For people: "stop 12 of 48, rotation 90, swing -20", or empty.
  [[nodiscard]] virtual std::string progress() const = 0;
  /// Why the recording that is being written lacks something, or nothing.
  [[nodiscard]] virtual std::optional<Error> recording_error() const { return std::nullopt; }
  /// Places where the recording that is read is damaged.
  [[nodiscard]] virtual std::vector<Error> damages() const = 0;
};

}  // namespace enamel::host
