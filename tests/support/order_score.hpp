// What became of the pixels of a burst whose true absolute phase is known.
#pragma once

#include <cstddef>
#include <cstdint>

#include "pipeline/decode/steps/decoded_burst.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::test {

/// Sums over bursts with +=. Lit pixels are masked (dark, saturated, noisy), beside a cut, undecided, or accepted.
struct OrderCounts {
  std::size_t bursts = 0, rejected_bursts = 0, bursts_with_large_wrong = 0;
  std::size_t lit = 0, masked = 0, edge = 0, undecided = 0, accepted = 0, wrong = 0;
  std::size_t band_accepted = 0, band_wrong = 0;  ///< within the band around jumps
  std::size_t largest_wrong_px = 0;               ///< of all connected regions of wrong pixels
  double squares_mm2 = 0;                         ///< depth error of accepted pixels of right order
  double sigma_mm2 = 0;                           ///< predicted variance of the same

  OrderCounts& operator+=(const OrderCounts& other);
  [[nodiscard]] double wrong_pct() const { return percent(wrong, accepted); }
  [[nodiscard]] double band_wrong_pct() const { return percent(band_wrong, band_accepted); }
  /// Of what the mask leaves.
  [[nodiscard]] double undecided_pct() const { return percent(undecided, lit - masked); }
  [[nodiscard]] double edge_pct() const { return percent(edge, lit - masked); }
  [[nodiscard]] double masked_pct() const { return percent(masked, lit); }
  [[nodiscard]] double rms_um() const;
  [[nodiscard]] double sigma_um() const;

 private:
  static double percent(std::size_t part, std::size_t whole) {
    return whole > 0 ? 100 * static_cast<double>(part) / static_cast<double>(whole) : 0;
  }
};

inline constexpr std::size_t kLargeWrong_px = 100;

/// A pixel is wrong when its phase is off by more than half a fringe. A rejected burst counts as undecided throughout
/// but for what the mask took out. band: as ToothSteps::near_jump.
[[nodiscard]] OrderCounts score_orders(const pipeline::DecodedBurst& burst, const SyntheticBurst& truth,
                                       const Map<double>& light, const Map<std::uint8_t>& band);

/// Pixels of the largest 4-connected region of the pixels that are not 0.
[[nodiscard]] std::size_t largest_region(const Map<std::uint8_t>& marked);

}  // namespace enamel::test
