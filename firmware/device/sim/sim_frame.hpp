// Sizes and times of simulated frames, and frames that show nothing. SIMULATION ONLY. Pure functions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "firmware/device/sim/burst_source.hpp"
#include "firmware/hal/hardware.hpp"

namespace enamel::fw {

/// Of one frame, in memory.
[[nodiscard]] std::size_t pixel_bytes(int width, int height, int bit_depth);

/// Every pixel at `dn8`, a level of 8 bits.
[[nodiscard]] std::vector<std::uint8_t> blank_frame(const CameraMode& mode, std::uint8_t dn8);

/// From frame to frame, in the source's time.
[[nodiscard]] std::int64_t frame_period_ns(const SimBurst& burst);

/// kConfigValue: an exposure that is no time or longer than its frame.
[[nodiscard]] Result<void> check_exposure(const SimBurst& burst);

}  // namespace enamel::fw
