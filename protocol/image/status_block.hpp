// What a probe tells of its firmware: one packed block, by UPLOAD and by the vendor request STATUS
// (docs/firmware-image.md §5). Both sides use this file.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "protocol/image/manifest.hpp"

namespace enamel::image {

/// A unit's serial, padded with zeros; the same in run mode and recovery.
using Serial = std::array<std::uint8_t, 16>;

struct StatusBlock {
  std::uint8_t active = 0;
  std::array<std::uint8_t, 2> slot_state{};  ///< numbers of SlotState, docs/firmware-image.md §4
  std::array<std::uint8_t, 2> tries{};
  std::array<ImageVersion, 2> version{};
  std::uint32_t min_security_counter = 0;
  std::uint32_t chunks_done = 0;  ///< of the download in hand
  std::uint32_t chunks_total = 0;
  Sha256Digest manifest_sha{};  ///< of the active slot
  Serial serial{};
  std::uint16_t hw_rev = 0;
  std::uint16_t battery_mv = 0;
  std::uint32_t last_error = 0;  ///< a Refusal's number, 0 none
  friend bool operator==(const StatusBlock&, const StatusBlock&) = default;
};

inline constexpr std::size_t kStatusSize = 95;
using StatusBytes = std::array<std::byte, kStatusSize>;

[[nodiscard]] StatusBytes encode(const StatusBlock& status) noexcept;
/// Nothing for other bytes: length, magic, version, a slot number above 1.
[[nodiscard]] std::optional<StatusBlock> decode_status(std::span<const std::byte> bytes) noexcept;

}  // namespace enamel::image
