// The captured set "blocks_3step_2freq_gray": building blocks before a box, projector gamma left in, no calibration.
// A test of tolerance, not of precision: what does unwrapping make of fringes that are no sinusoids?
#pragma once

#include <cstddef>
#include <string>

#include "protocol/base/result.hpp"

namespace enamel::test {

struct BlocksFigures {
  std::size_t lit_px = 0;     ///< modulation above 10 DN
  std::size_t solved_px = 0;  ///< of these, in unwrapped segments of 64 px or more
  double orders_equal = 0;    ///< share of solved pixels not more than 0.6 rad outside their Gray cell
  double orders_literal = 0;  ///< share whose order is that of the cell; blur and noise at its borders count as wrong
  double largest_share = 0;   ///< of the solved pixels, in the largest segment
  double links_torn = 0;      ///< share of links whose two ends lie in different fringes by the Gray code
  double ripple_before = 0;   ///< rms of the three-step error that levelling of the phase's distribution finds, rad
  double ripple_after = 0;    ///< … and of what it still finds afterwards
};

[[nodiscard]] Result<BlocksFigures> measure_blocks(const std::string& folder);

}  // namespace enamel::test
