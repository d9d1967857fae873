// Which slot boots. A pure decision on the control block (docs/firmware-image.md §4); the flash is asked through an
// interface, so that a test can answer for it.
#pragma once

#include <cstdint>
#include <optional>

#include "firmware/boot/control_block.hpp"

namespace enamel::fw {

inline constexpr std::uint8_t kTrialBoots = 3;

namespace bad_reason {
inline constexpr std::uint8_t kNoTriesLeft = 1;
inline constexpr std::uint8_t kDoesNotVerify = 2;
inline constexpr std::uint8_t kRolledBack = 3;
}  // namespace bad_reason

/// Answers whether a slot's whole content verifies. Called at most once a slot and decision.
class SlotJudge {
 public:
  virtual ~SlotJudge() = default;
  [[nodiscard]] virtual bool verifies(std::size_t slot) noexcept = 0;
};

struct BootDecision {
  std::optional<std::size_t> slot;  ///< nothing: recovery
  /// To be stored before the jump, when it differs from what was loaded.
  ControlBlock block;
};

/// Decides from a valid block. `trials` false leaves slots on trial out and changes nothing: for a block that cannot be
/// stored, because a trial whose cost is not written down would never end.
[[nodiscard]] BootDecision decide(const ControlBlock& loaded, SlotJudge& judge, bool trials = true) noexcept;

/// Loads, decides, stores what must be stored, and names the slot to jump to; nothing: recovery. Neither copy valid:
/// any slot that verifies.
[[nodiscard]] std::optional<std::size_t> choose_slot(ControlStore& store, SlotJudge& judge) noexcept;

/// The slot that recovery leaves alone while it writes the other: what would boot without a trial, else what would boot
/// at all, else the active one. Stores nothing.
[[nodiscard]] std::size_t slot_to_keep(const ControlStore& store, SlotJudge& judge) noexcept;

}  // namespace enamel::fw
