// What many deviations, or one figure over many runs, come to.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace enamel::host {

/// Of signed deviations, um.
struct DeviationFigures {
  std::size_t count = 0;
  double mean_abs_um = 0;  ///< of |d|
  double mean_um = 0;      ///< signed
  double rms_um = 0;
  double p95_um = 0;      ///< 95 % of |d| are smaller
  double half_80_um = 0;  ///< (90 % - 10 %) / 2 of the signed ones: what a shift of the whole does not touch
};

/// All zero for none.
[[nodiscard]] DeviationFigures figures_of(std::vector<double> deviation_um);

/// Width of the interval that leaves out as many of the smallest as of the largest; 0 for none. share: 0 … 1, kept.
[[nodiscard]] double range_of(std::vector<double> values, double share);

/// Of one figure over runs or pairs.
struct Spread {
  double mean = 0;
  std::optional<double> sd;  ///< with n - 1; none for a single value
};
[[nodiscard]] Spread spread_of(std::span<const double> values);

}  // namespace enamel::host
