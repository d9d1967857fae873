#include "firmware/boot/policy.hpp"

#include <array>

namespace enamel::fw {
namespace {

/// Asks the judge once a slot.
class Verdicts {
 public:
  explicit Verdicts(SlotJudge& judge) noexcept : judge_(&judge) {}
  [[nodiscard]] bool verifies(std::size_t slot) noexcept {
    if (!known_[slot]) known_[slot] = judge_->verifies(slot);
    return *known_[slot];
  }

 private:
  SlotJudge* judge_;
  std::array<std::optional<bool>, kSlots> known_;
};

bool on_trial(const SlotRecord& slot) noexcept {
  return slot.state == SlotState::kPending || slot.state == SlotState::kTrial;
}

/// A slot on trial boots, and pays for it, or is given up.
bool try_trial(SlotRecord& slot, bool verifies) noexcept {
  if (slot.tries == 0 || !verifies) {
    slot.reason = slot.tries == 0 ? bad_reason::kNoTriesLeft : bad_reason::kDoesNotVerify;
    slot.state = SlotState::kBad;
    return false;
  }
  slot.state = SlotState::kTrial;
  --slot.tries;
  return true;
}

}  // namespace

BootDecision decide(const ControlBlock& loaded, SlotJudge& judge, bool trials) noexcept {
  Verdicts verdicts(judge);
  BootDecision d{std::nullopt, loaded};
  const std::array<std::size_t, kSlots> order = {loaded.active, std::size_t{1} - loaded.active};
  if (trials) {
    for (const std::size_t i : order) {
      SlotRecord& slot = d.block.slot[i];
      if (!on_trial(slot) || !try_trial(slot, slot.tries > 0 && verdicts.verifies(i))) continue;
      ++d.block.boot_count;
      d.slot = i;
      return d;
    }
  }
  for (const SlotState wanted : {SlotState::kConfirmed, SlotState::kVerified, SlotState::kEmpty}) {
    for (const std::size_t i : order) {
      if (d.block.slot[i].state != wanted || !verdicts.verifies(i)) continue;
      d.slot = i;
      return d;
    }
  }
  return d;
}

std::optional<std::size_t> choose_slot(ControlStore& store, SlotJudge& judge) noexcept {
  const std::optional<ControlBlock> loaded = store.load();
  if (!loaded) return decide(ControlBlock{}, judge).slot;
  const BootDecision decision = decide(*loaded, judge);
  if (decision.block == *loaded || store.store(decision.block)) return decision.slot;
  return decide(*loaded, judge, false).slot;
}

std::size_t slot_to_keep(const ControlStore& store, SlotJudge& judge) noexcept {
  const ControlBlock block = store.load().value_or(ControlBlock{});
  if (const std::optional<std::size_t> lasting = decide(block, judge, false).slot) return *lasting;
  return decide(block, judge).slot.value_or(block.active);
}

}  // namespace enamel::fw
