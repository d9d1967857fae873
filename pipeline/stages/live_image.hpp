// A burst's fringe-free picture for people.
#pragma once

#include <cstdint>

#include "pipeline/types/map.hpp"

namespace enamel::stage {

/// DN above black, cut to 0…255; no surface (NaN) is black.
[[nodiscard]] Map<std::uint8_t> live_image(const Map<float>& texture_dn);

}  // namespace enamel::stage
