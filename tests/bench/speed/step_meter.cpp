#include "tests/bench/speed/step_meter.hpp"

#include <algorithm>

#include "tests/bench/thread_time.hpp"

namespace enamel::bench {

void StepMeter::begin(const flow::Stage& /*stage*/, std::optional<BurstId> /*burst*/) noexcept {
  if (!std::exchange(tried_, true)) counter_.open();
  begun_.heap = heap_use();
  begun_.core_ms = thread_ms();
  begun_.instructions = counter_.value();
}

void StepMeter::end(const flow::Stage& stage, const flow::StepOutcome& outcome) noexcept {
  const std::uint64_t instructions = counter_.value();
  const double core_ms = thread_ms();
  const HeapUse heap = heap_use();
  if (!outcome.burst) return;
  StepCost cost;
  cost.burst = outcome.burst->value;
  cost.instructions = instructions - begun_.instructions;
  cost.core_ms = core_ms - begun_.core_ms;
  cost.heap = {heap.blocks - begun_.heap.blocks, heap.bytes - begun_.heap.bytes};
  costs_.push_back({&stage, stage.family(), cost});
}

std::map<std::string, std::vector<StepCost>> StepMeter::by_stage() const {
  std::map<std::string, std::vector<StepCost>> out;
  for (const Noted& noted : costs_) out[noted.family].push_back(noted.cost);
  for (auto& [name, costs] : out) std::ranges::sort(costs, {}, &StepCost::burst);
  return out;
}

}  // namespace enamel::bench
