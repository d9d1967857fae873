// What light did over a whole scan: trouble by kind, light from inside, and what to do about it.
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace enamel::host {

/// Over the fused bursts.
struct SightTotals {
  std::map<std::string, std::uint64_t> bursts;  ///< by the name of the trouble: glare, metal, lamp, fog
  std::uint64_t translucent_bursts = 0;         ///< whose depth was corrected
  double translucent_share = 0;                 ///< of the measured surface, sum over these
  double lifted_mm = 0;                         ///< mean apparent depth, sum over these by that share
  double unsure_share = 0;                      ///< of what was lifted: one standard deviation of what is left

  [[nodiscard]] double lifted_um() const noexcept;
  [[nodiscard]] double left_sigma_um() const noexcept { return unsure_share * lifted_um(); }
};

/// "12 bursts glare: dry there, or turn the probe; …", or empty where nothing was in the way of more than a few.
[[nodiscard]] std::string sight_line(const SightTotals& totals);
/// "light from inside: lifted by 25 um, +- 9", or empty.
[[nodiscard]] std::string translucency_line(const SightTotals& totals);

}  // namespace enamel::host
