// What each step of each stage costs: instructions, processor time, heap blocks. For runs on one thread.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "pipeline/flow/stage.hpp"
#include "pipeline/flow/step_observer.hpp"
#include "tests/bench/speed/instruction_counter.hpp"
#include "tests/bench/speed/malloc_count.hpp"

namespace enamel::bench {

struct StepCost {
  std::uint64_t burst = 0;
  std::uint64_t instructions = 0;  ///< user mode; 0 without a counter
  double core_ms = 0;
  HeapUse heap;
};

/// Takes its readings last in begin() and first in end(), so that its own work is outside.
class StepMeter final : public flow::StepObserver {
 public:
  explicit StepMeter(std::size_t steps) { costs_.reserve(steps); }

  void begin(const flow::Stage& stage, std::optional<BurstId> burst) noexcept override;
  void end(const flow::Stage& stage, const flow::StepOutcome& outcome) noexcept override;

  /// By stage; replicas of one stage under its name. In order of bursts.
  [[nodiscard]] std::map<std::string, std::vector<StepCost>> by_stage() const;
  [[nodiscard]] const InstructionCounter& counter() const noexcept { return counter_; }

 private:
  struct Noted {
    const flow::Stage* stage;
    std::string family;  ///< short: kept in place, without a heap block
    StepCost cost;
  };

  InstructionCounter counter_;  ///< opened by the first step, on the thread that runs all of them
  bool tried_ = false;
  StepCost begun_;
  std::vector<Noted> costs_;
};

}  // namespace enamel::bench
