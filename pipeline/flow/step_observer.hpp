// Looks on while stages work: what a measurement of a stage hangs on. It never influences results.
#pragma once

#include <optional>

#include "protocol/base/ids.hpp"

namespace enamel::flow {

class Stage;

struct StepOutcome {
  std::optional<BurstId> burst;  ///< none: a pull that brought nothing
  bool rejected = false;         ///< it came in, or leaves on some Out, as a tombstone
  bool failed = false;           ///< step() or pull() returned an error or threw
};

/// Each step of a stage and each pull of a source is one begin() and one end(), both on the thread that runs it and
/// around nothing else; tombstones that are passed on without a step as well. Steps of one stage never overlap, those
/// of different stages do where there are workers: then both calls come from several threads at once.
class StepObserver {
 public:
  virtual ~StepObserver() = default;
  /// burst: none for a pull, which has yet to find one.
  virtual void begin(const Stage& stage, std::optional<BurstId> burst) noexcept = 0;
  virtual void end(const Stage& stage, const StepOutcome& outcome) noexcept = 0;
};

}  // namespace enamel::flow
