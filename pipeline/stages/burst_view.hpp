// A burst's frames as the decoder takes them.
#pragma once

#include "pipeline/decode/phase/burst_view.hpp"
#include "protocol/types/burst.hpp"

namespace enamel::stage {

/// Needs proto::is_consistent(burst); refers to the burst's memory.
[[nodiscard]] inline pipeline::BurstView view_of(const proto::Burst& burst) noexcept {
  pipeline::BurstView view{.width = burst.width, .height = burst.height, .bit_depth = burst.bit_depth};
  for (int k = 0; k < proto::kFramesPerBurst; ++k)
    view.frames[static_cast<std::size_t>(k)] = proto::frame_bytes(burst, k);
  return view;
}

}  // namespace enamel::stage
