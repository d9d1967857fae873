// What the running firmware may do to the control block: pure functions, each one step of the diagram in
// docs/firmware-image.md §4.
#pragma once

#include "firmware/boot/control_block.hpp"
#include "protocol/image/refusal.hpp"

namespace enamel::fw {

/// The slot that is not running becomes WRITING. kNotConfirmed while the running one is on trial: the other may be the
/// only one known to be good. A block without any record of the running slot (factory) is no obstacle.
[[nodiscard]] image::Checked<ControlBlock> begin_writing(ControlBlock block, std::size_t running,
                                                         const Sha256Digest& manifest_sha) noexcept;
/// WRITING becomes VERIFIED, with what the manifest says.
[[nodiscard]] ControlBlock mark_verified(ControlBlock block, std::size_t slot,
                                         const image::Manifest& manifest) noexcept;
/// VERIFIED becomes PENDING with all its tries.
[[nodiscard]] ControlBlock mark_pending(ControlBlock block, std::size_t slot) noexcept;
/// The running slot is CONFIRMED and active; the other one keeps its state.
[[nodiscard]] ControlBlock confirm(ControlBlock block, std::size_t running) noexcept;
/// Raises the minimum counter to the least of the CONFIRMED slots, or with `committed` to the active one's. Never
/// lowers.
[[nodiscard]] ControlBlock raise_counter(ControlBlock block, bool committed) noexcept;
/// The other slot becomes active; a trial of the running one ends. kNotConfirmed when the other is not CONFIRMED.
[[nodiscard]] image::Checked<ControlBlock> roll_back(ControlBlock block, std::size_t running) noexcept;

}  // namespace enamel::fw
