// A burst to what travels on of it, with the reasons for which it does not: pure, for stages and for scans by stops.
#pragma once

#include <cstdint>
#include <optional>

#include "pipeline/decode/burst_decoder.hpp"
#include "pipeline/stages/items.hpp"

namespace enamel::stage {

struct DecodedOrNot {
  std::optional<Decoded> decoded;
  const char* rejected = nullptr;  ///< the reason, where there is nothing
};

/// calib_crc32: of the rig in force; bursts that name another are rejected. 0: any. `wave`: known of the projector.
/// Needs proto::is_consistent(burst).
[[nodiscard]] DecodedOrNot decode_burst(const pipeline::BurstDecoder& decoder, const proto::Burst& burst,
                                        std::uint32_t calib_crc32, const pipeline::WaveKnowledge& wave,
                                        pipeline::DecodeWorkspace& workspace);

}  // namespace enamel::stage
