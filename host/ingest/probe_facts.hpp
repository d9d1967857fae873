// What a probe's messages say, asked the same way by everyone who follows one. Pure functions, thread-safe.
#pragma once

#include <cstdint>
#include <string>

#include "protocol/base/clock.hpp"
#include "protocol/base/result.hpp"
#include "protocol/base/time.hpp"
#include "protocol/types/burst.hpp"
#include "protocol/types/device.hpp"

namespace enamel::host {

/// rig.json that the probe carries, byte for byte. Errors: kRigMissing; kRigInvalid when it came damaged.
[[nodiscard]] Result<std::string> rig_text_of(const proto::DeviceInfo& info);

/// A twin or a player says so of itself.
[[nodiscard]] bool says_simulated(const proto::DeviceInfo& info);

/// Needs proto::is_consistent(burst).
[[nodiscard]] DeviceTime end_of_exposure(const proto::Burst& burst);

/// Of a session that begins now: never 0, which stands for none.
[[nodiscard]] std::uint32_t new_session_id(const Clock& clock);

}  // namespace enamel::host
