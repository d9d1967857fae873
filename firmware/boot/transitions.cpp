#include "firmware/boot/transitions.hpp"

#include <algorithm>
#include <limits>

#include "firmware/boot/policy.hpp"

namespace enamel::fw {

image::Checked<void> may_overwrite_other(const ControlBlock& block, std::size_t running) noexcept {
  const SlotState state = block.slot[running].state;
  if (state == SlotState::kConfirmed || state == SlotState::kVerified || state == SlotState::kEmpty) return {};
  return image::refuse(image::Refusal::kNotConfirmed);
}

ControlBlock begin_writing(ControlBlock block, std::size_t slot, const Sha256Digest& manifest_sha) noexcept {
  SlotRecord& record = block.slot[slot];
  record = {};
  record.state = SlotState::kWriting;
  record.manifest_sha = manifest_sha;
  return block;
}

ControlBlock mark_verified(ControlBlock block, std::size_t slot, const image::Manifest& manifest) noexcept {
  SlotRecord& record = block.slot[slot];
  record.state = SlotState::kVerified;
  record.version = manifest.version;
  record.security_counter = manifest.security_counter;
  return block;
}

ControlBlock mark_pending(ControlBlock block, std::size_t slot) noexcept {
  block.slot[slot].state = SlotState::kPending;
  block.slot[slot].tries = kTrialBoots;
  return block;
}

ControlBlock confirm(ControlBlock block, std::size_t running) noexcept {
  if (block.slot[running].state == SlotState::kBad) return block;
  block.slot[running].state = SlotState::kConfirmed;
  block.slot[running].tries = 0;
  block.active = static_cast<std::uint8_t>(running);
  return block;
}

ControlBlock raise_counter(ControlBlock block, bool committed) noexcept {
  std::uint32_t least = std::numeric_limits<std::uint32_t>::max();
  for (std::size_t i = 0; i < kSlots; ++i) {
    const SlotRecord& slot = block.slot[i];
    if (slot.state == SlotState::kConfirmed && (!committed || i == block.active)) {
      least = std::min(least, slot.security_counter);
    }
  }
  if (least != std::numeric_limits<std::uint32_t>::max()) {
    block.min_security_counter = std::max(block.min_security_counter, least);
  }
  return block;
}

image::Checked<ControlBlock> roll_back(ControlBlock block, std::size_t running) noexcept {
  if (block.slot[1 - running].state != SlotState::kConfirmed) return image::refuse(image::Refusal::kNotConfirmed);
  block.active = static_cast<std::uint8_t>(1 - running);
  SlotRecord& left = block.slot[running];
  if (left.state == SlotState::kTrial || left.state == SlotState::kPending) {
    // It would boot again before the active one.
    left.state = SlotState::kBad;
    left.reason = bad_reason::kRolledBack;
  }
  return block;
}

}  // namespace enamel::fw
