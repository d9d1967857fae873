// A scan as the program sees it: bursts come from somewhere, go through the pipeline and leave a result. A live probe
// and a recording that is played back are two sources of the same.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/rig.hpp"
#include "host/report/accounting.hpp"
#include "host/session/scan_pipeline.hpp"
#include "pipeline/types/preview.hpp"
#include "protocol/base/result.hpp"

namespace enamel::host {

/// What a session leaves behind, whatever went wrong on the way.
struct Outcome {
  ScanResult scan;
  BurstCounts counts;
  bool simulated = false;
  std::string device_serial;             ///< of the probe that made the bursts; may be empty
  std::string scanned_at;                ///< UTC; empty when a recording does not say
  std::vector<Error> damages;            ///< records that could not be read, in order; counted as incomplete
  std::optional<Error> broken_off;       ///< a probe lost for good: what was scanned is kept
  std::optional<Error> recording_error;  ///< the recording holds what came before
};

[[nodiscard]] inline PreviewCounters counters_of(const BurstCounts& c) {
  return {c.captured, c.fused, c.rejected_total(), c.shed, c.incomplete, c.lost_on_wire, c.accepted};
}

/// One thread owns it; stop() and set_scanning() may come from any.
class Session {
 public:
  Session() = default;
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  virtual ~Session() = default;

  virtual void start() = 0;
  virtual void stop() = 0;  ///< no more bursts; what is inside is worked off
  virtual void set_scanning(bool wanted) = 0;
  [[nodiscard]] virtual bool scanning_wanted() const = 0;
  [[nodiscard]] virtual bool ended() const = 0;

  /// State, message, counters and badge as they are now; bursts come through preview(), stages through figures().
  [[nodiscard]] virtual PreviewFrame view() const = 0;
  /// Where the pipeline leaves the newest burst; null before the rig is known. One taker.
  [[nodiscard]] virtual PreviewSlot* preview() = 0;
  /// The burst, of preview(), is on the screen since `at`, for the first time. Of use to those that know when it was
  /// exposed.
  virtual void shown([[maybe_unused]] BurstId burst, [[maybe_unused]] HostTime at) {}
  /// How the stages get on; null before the first burst.
  [[nodiscard]] virtual std::shared_ptr<const PipelineFigures> figures() const = 0;
  /// That measures, once known.
  [[nodiscard]] virtual std::optional<calib::Rig> rig() const = 0;

  /// Waits for the end and hands everything over, once. Errors: those that left nothing to keep.
  [[nodiscard]] virtual Result<Outcome> finish() = 0;
};

}  // namespace enamel::host
