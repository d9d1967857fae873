// The dissertation's own way to absolute orders, to compare with: the fourth frame is flipped over one fringe only, the
// marker, which is found as the difference B4 - B3 of the four-frame and the three-frame modulation; fringes are
// counted from there by unwrapping. B4 - B3 is about -(r/2) sin phi with closure residual r: on the marker it averages
// (2/pi - 1) B, elsewhere 0 (algorithms.md §2.1).
#pragma once

#include "pipeline/algo/phase/phase.hpp"
#include "pipeline/algo/unwrap/flood.hpp"

namespace enamel::test {

struct MarkerOrders {
  Map<std::int32_t> order;  ///< floor(Phi / 2 pi); -1 where the pixel's component does not show the marker
  int components_placed = 0;
};

[[nodiscard]] MarkerOrders orders_from_marker(const algo::PhaseMaps& phase, const algo::FloodMaps& flood,
                                              int marker_fringe);

}  // namespace enamel::test
