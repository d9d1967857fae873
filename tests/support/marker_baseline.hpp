// The dissertation's own way to absolute orders, to compare with: the fourth frame is flipped over one fringe only, the
// marker, which is found as the difference B4 - B3 of the four-frame and the three-frame modulation; fringes are
// counted from there by unwrapping. B4 - B3 is about -(r/2) sin phi with closure residual r: on the marker it averages
// (2/pi - 1) B, elsewhere 0 (docs/decode.md §2).
#pragma once

#include "calib/model/rig.hpp"
#include "pipeline/decode/phase/burst_view.hpp"
#include "pipeline/decode/triangulate/ray_depth.hpp"
#include "pipeline/types/map.hpp"

namespace enamel::test {

struct MarkerOrders {
  Map<std::int32_t> order;  ///< floor(Phi / 2 pi); -1 where the pixel's component does not show the marker
  Map<float> phase_rad;     ///< [-pi, pi)
  int components_placed = 0;
};

/// A burst of mode single with depth range and noise in its rig, through the decoder's own phase, links and unwrapping.
/// Orders stand where no pixel is rejected.
[[nodiscard]] MarkerOrders orders_from_marker(const calib::Rig& rig, const pipeline::BurstView& view);

/// The same with the rig's geometry baked before: for many bursts.
[[nodiscard]] MarkerOrders orders_from_marker(const calib::Rig& rig, const pipeline::RayDepth& rays,
                                              const pipeline::BurstView& view);

}  // namespace enamel::test
