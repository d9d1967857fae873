// Where things lie on the flash (docs/firmware-image.md §3).
#pragma once

#include <array>
#include <cstdint>

#include "firmware/hal/flash.hpp"
#include "protocol/image/manifest.hpp"

namespace enamel::fw {

inline constexpr std::size_t kSlots = 2;

namespace flash_map {
inline constexpr std::uint64_t kManifestArea = image::kMaxManifest;
inline constexpr std::uint64_t kSlotSize = kManifestArea + image::kMaxPayload;
inline constexpr std::uint64_t kControl = 0;
inline constexpr std::uint64_t kSlot = kControl + 2 * kEraseBlock;
inline constexpr std::uint64_t kConfig = kSlot + kSlots * kSlotSize;
inline constexpr std::uint64_t kUpdaterEnd = kConfig + kEraseBlock;  ///< what an update may ever write ends here
inline constexpr std::uint64_t kCalibration = kUpdaterEnd;
inline constexpr std::uint64_t kSize = kCalibration + 2 * kEraseBlock;
static_assert(kManifestArea % kEraseBlock == 0 && image::kChunkSize == kEraseBlock);
}  // namespace flash_map

/// What updater and bootloader may touch. Calibration and keys are no part of it.
struct BootRegions {
  std::array<FlashRegion, 2> control;
  std::array<FlashRegion, kSlots> slot;
  FlashRegion config;
};

[[nodiscard]] inline BootRegions boot_regions(Flash& flash) noexcept {
  const auto copy = [&](std::uint64_t i) {
    return FlashRegion(flash, flash_map::kControl + i * kEraseBlock, kEraseBlock);
  };
  const auto slot = [&](std::uint64_t i) {
    return FlashRegion(flash, flash_map::kSlot + i * flash_map::kSlotSize, flash_map::kSlotSize);
  };
  return {{copy(0), copy(1)}, {slot(0), slot(1)}, FlashRegion(flash, flash_map::kConfig, kEraseBlock)};
}

}  // namespace enamel::fw
