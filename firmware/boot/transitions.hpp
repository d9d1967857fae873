// What the running firmware may do to the control block: pure functions, each one step of the diagram in
// docs/firmware-image.md §4.
#pragma once

#include "firmware/boot/control_block.hpp"
#include "protocol/image/refusal.hpp"

namespace enamel::fw {

/// Whether the slot that is not running may be overwritten. kNotConfirmed while the running one would not boot by
/// itself, on trial or rolled back: the other may be the only one known to be good. No record of the running slot (both
/// copies of the block were lost) is no obstacle: it boots as the last choice.
[[nodiscard]] image::Checked<void> may_overwrite_other(const ControlBlock& block, std::size_t running) noexcept;
/// The slot becomes WRITING.
[[nodiscard]] ControlBlock begin_writing(ControlBlock block, std::size_t slot,
                                         const Sha256Digest& manifest_sha) noexcept;
/// WRITING becomes VERIFIED, with what the manifest says.
[[nodiscard]] ControlBlock mark_verified(ControlBlock block, std::size_t slot,
                                         const image::Manifest& manifest) noexcept;
/// VERIFIED becomes PENDING with all its tries.
[[nodiscard]] ControlBlock mark_pending(ControlBlock block, std::size_t slot) noexcept;
/// The running slot is CONFIRMED and active; the other one keeps its state. A slot that was rolled back (BAD) stays so.
[[nodiscard]] ControlBlock confirm(ControlBlock block, std::size_t running) noexcept;
/// Raises the minimum counter to the least of the CONFIRMED slots, or with `committed` to the active one's. Never
/// lowers.
[[nodiscard]] ControlBlock raise_counter(ControlBlock block, bool committed) noexcept;
/// The other slot becomes active; a trial of the running one ends. kNotConfirmed when the other is not CONFIRMED.
[[nodiscard]] image::Checked<ControlBlock> roll_back(ControlBlock block, std::size_t running) noexcept;

}  // namespace enamel::fw
