#include "pipeline/flow/step_observer.hpp"

#include "pipeline/flow/stage_runner.hpp"

namespace enamel::flow {

StepOutcome outcome_of(const Stage& stage, const ItemHead* in, bool failed) {
  StepOutcome outcome{.burst = {}, .rejected = false, .failed = failed};
  if (in != nullptr) outcome = {.burst = in->id, .rejected = !in->ok(), .failed = failed};
  for (const OutBase* out : stage.outs()) {
    if (out->emitted() == 0) continue;
    if (!outcome.burst) outcome.burst = out->last().id;
    outcome.rejected = outcome.rejected || !out->last().ok();
  }
  return outcome;
}

}  // namespace enamel::flow
