// A rendered burst as the message that a probe would have sent.
#pragma once

#include "firmware/device/sim/burst_source.hpp"
#include "protocol/types/burst.hpp"

namespace enamel::twin {

/// calib_crc32: CRC-32 of the rig's text.
[[nodiscard]] proto::Burst to_message(const fw::SimBurst& burst, std::uint32_t calib_crc32);

}  // namespace enamel::twin
