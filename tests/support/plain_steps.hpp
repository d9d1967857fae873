// The steps of plain_decoder.hpp, in their order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "calib/model/lens.hpp"
#include "pipeline/decode/phase/burst_view.hpp"
#include "pipeline/types/map.hpp"

namespace enamel::test::plain {

/// What the frames show, levels in the DN of rig.noise.
struct Fringes {
  Map<double> phase_rad;     ///< wrapped, -pi … pi
  Map<double> relative;      ///< noise of one frame (1 sigma) over the modulation
  Map<double> code_dn;       ///< frame with the code less the mean light
  Map<double> wave_dn;       ///< what the code is written on: B sin(phi) in mode T, B in mode M
  Map<std::uint8_t> usable;  ///< modulated well above the noise, neither dark nor saturated
};
[[nodiscard]] Fringes solve_fringes(const calib::Rig& rig, const pipeline::BurstView& view);

using Pixels = std::vector<std::size_t>;  ///< indices into a map

struct Segments {
  Map<double> phase_rad;        ///< continuous along the links of a segment: right but for 2 pi k
  std::vector<Pixels> members;  ///< of those large enough to be placed
};
[[nodiscard]] Segments unwrap_segments(const Fringes& fringes);

/// Where a pixel's ray lies in the projector at the near and the far end of the depth range, in fringes.
struct FringeSpan {
  Map<double> low, high;
};
[[nodiscard]] FringeSpan fringe_span(const calib::Rig& rig, const calib::RayTable& rays);

/// Absolute phase, rad; NaN where no fringe number is clearly the best.
[[nodiscard]] Map<double> number_fringes(const calib::PatternValues& pattern, const Fringes& fringes,
                                         const Segments& segments, const FringeSpan& span);

[[nodiscard]] Map<float> triangulate(const calib::Rig& rig, const calib::RayTable& rays, const Map<double>& phase_rad);

/// Sum over 2 half_v + 1 rows of 2 half_u + 1 pixels about each; nothing lies beyond the border.
[[nodiscard]] Map<double> window_sums(const Map<double>& image, int half_u, int half_v);

}  // namespace enamel::test::plain
