// Coldest and warmest of what came.
#pragma once

#include <algorithm>
#include <array>
#include <optional>

#include "protocol/types/burst.hpp"

namespace enamel::host {

using TempRange = std::optional<std::array<double, 2>>;  ///< degrees C; empty: nothing came yet

inline void take_in(const proto::Burst& burst, TempRange& range) {
  const double temp_c = burst.temp_centi_c / 100.0;
  range = range ? std::array{std::min((*range)[0], temp_c), std::max((*range)[1], temp_c)} : std::array{temp_c, temp_c};
}

}  // namespace enamel::host
