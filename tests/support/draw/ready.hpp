// A drawn burst whose rig a decoder takes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/decode/burst_decoder.hpp"
#include "tests/support/draw/conditions.hpp"

namespace enamel::test {

struct ReadyDraw {
  Drawn drawn;
  std::optional<pipeline::BurstDecoder> decoder;  ///< nothing: the decoder has taken none of many
  std::vector<std::string> refused;               ///< why the draws before it were refused when their rigs were loaded
};

/// Draws until the decoder takes the rig.
[[nodiscard]] ReadyDraw ready_draw(std::uint64_t seed, calib::PatternMode mode);

}  // namespace enamel::test
