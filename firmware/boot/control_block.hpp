// Boot control block: which slot boots, and what is known of each (docs/firmware-image.md §4). No heap, no log: a
// bootloader takes this folder as it is.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "firmware/boot/flash_map.hpp"
#include "protocol/base/sha256.hpp"
#include "protocol/image/manifest.hpp"

namespace enamel::fw {

enum class SlotState : std::uint8_t {
  kEmpty = 0,  ///< nothing is known of it: boots as the last choice, when what lies there verifies
  kWriting = 1,
  kVerified = 2,
  kPending = 3,
  kTrial = 4,
  kConfirmed = 5,
  kBad = 6,
};

struct SlotRecord {
  SlotState state = SlotState::kEmpty;
  std::uint8_t tries = 0;   ///< boots left while PENDING or TRIAL; means nothing otherwise
  std::uint8_t reason = 0;  ///< why BAD: bad_reason of policy.hpp
  image::ImageVersion version;
  std::uint32_t security_counter = 0;
  Sha256Digest manifest_sha{};
  friend bool operator==(const SlotRecord&, const SlotRecord&) = default;
};

struct ControlBlock {
  std::uint32_t seq = 0;
  std::uint8_t active = 0;
  std::uint32_t min_security_counter = 0;
  std::array<SlotRecord, kSlots> slot;
  std::uint32_t boot_count = 0;  ///< boots that were written down: those of a trial
  std::uint32_t revoked = 0;
  friend bool operator==(const ControlBlock&, const ControlBlock&) = default;
};

inline constexpr std::size_t kControlSize = 512;
using ControlBytes = std::array<std::byte, kControlSize>;

[[nodiscard]] ControlBytes encode(const ControlBlock& block) noexcept;
/// Nothing for bytes that `encode` cannot have made: magic, CRC, states, slot number, reserved bytes.
[[nodiscard]] std::optional<ControlBlock> decode(std::span<const std::byte> bytes) noexcept;

/// The two copies. Not thread-safe: one program at a time owns them.
class ControlStore {
 public:
  explicit ControlStore(const std::array<FlashRegion, 2>& copies) noexcept : copies_(copies) {}

  /// The valid copy with the higher sequence number (serial arithmetic, RFC 1982); nothing when neither is valid.
  [[nodiscard]] std::optional<ControlBlock> load() const noexcept;
  /// Writes `block` over the older copy with the next sequence number and reads it back. False when that fails; the
  /// newer copy is never touched, so what was stored before is still in force.
  [[nodiscard]] bool store(ControlBlock block) noexcept;
  /// Writes it over one copy after the other, so that what is confirmed survives the loss of either. False when not
  /// even the first could be written.
  [[nodiscard]] bool store_twice(const ControlBlock& block) noexcept;

 private:
  [[nodiscard]] std::optional<ControlBlock> load(std::size_t copy) const noexcept;

  std::array<FlashRegion, 2> copies_;
};

}  // namespace enamel::fw
