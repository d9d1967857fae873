// What light did over a whole scan: trouble by kind, light from inside, and what to do about it.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "pipeline/types/sight.hpp"

namespace enamel::host {

/// Over the fused bursts.
struct SightTotals {
  std::array<std::uint64_t, kSightTroubles> bursts{};  ///< by SightTrouble
  std::uint64_t translucent_bursts = 0;                ///< whose depth was corrected
  double translucent_share = 0;                        ///< sums over these …
  double apparent_depth_mm = 0;                        ///< … weighted by their share

  void add(const Sight& sight) noexcept;
  /// Mean of what translucent surface was lifted by, and one standard deviation of what that is off by, um.
  [[nodiscard]] double apparent_depth_um() const noexcept;
  [[nodiscard]] double left_um() const noexcept;
};

/// Object: bursts by trouble, and `translucency`.
[[nodiscard]] std::string sight_json(const SightTotals& totals);
/// "12 bursts glare: dry there, or turn the probe; …", or empty where nothing was in the way of more than a few.
[[nodiscard]] std::string sight_line(const SightTotals& totals);
/// "light from inside: lifted by 25 um, +- 9", or empty.
[[nodiscard]] std::string translucency_line(const SightTotals& totals);

}  // namespace enamel::host
