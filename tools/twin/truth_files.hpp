// Truth in the exchange folder's form (docs/recording-format.md).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/twin/twin_source.hpp"

namespace enamel::twin {

/// Header line and rows of truth/poses.csv.
[[nodiscard]] std::string poses_header();
[[nodiscard]] std::string poses_row(const BurstTruth& truth);

/// Header line and rows of truth/movers.csv: one a burst and body that was there.
[[nodiscard]] std::string movers_header();
[[nodiscard]] std::string movers_rows(const BurstTruth& truth, const std::vector<MoverConfig>& movers);

/// PFM: "Pf", scale -1.0, rows bottom-up.
[[nodiscard]] std::string pfm(const std::vector<float>& values, int width, int height);

}  // namespace enamel::twin
