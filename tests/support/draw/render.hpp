// The four frames of a drawn burst, and the truth at mid-burst. Shares the lens formula of calib/model with the
// decoder, nothing else.
#pragma once

#include <array>
#include <cstdint>

#include "pipeline/types/map.hpp"
#include "tests/support/draw/conditions.hpp"
#include "tests/unit/decode/frame_set.hpp"

namespace enamel::test {

/// At mid-burst, at pixel centres.
struct DrawnTruth {
  Map<float> depth_mm;             ///< NaN: no surface
  Map<double> column_px;           ///< of the projector; NaN: no surface
  Map<std::uint8_t> lit;           ///< the projector's ray reaches the point, inside the projector's frame
  Map<std::uint8_t> near_edge;     ///< within kEdgeBand_px of a jump of depth
  Map<float> sigma_phi_rad;        ///< by three frames from the noise-free light and the sensor; infinite where clipped
  double fastest_rad_a_frame = 0;  ///< 95 % of the lit pixels away from edges change their phase by less
};
inline constexpr int kEdgeBand_px = 5;

struct DrawnBurst {
  FrameSet frames;
  DrawnTruth truth;
};

/// What one exposure differs by from the drawn one.
struct Shot {
  double later_s = 0;                                    ///< the burst is taken that much later on the same motion
  std::uint64_t noise = 0;                               ///< noise of its own
  std::array<double, 4> gain = {1, 1, 1, 1};             ///< of the frames' exposure
  std::array<bool, 4> taken = {true, true, true, true};  ///< frames; truth that all four tell is there if all are
  bool with_truth = true;
};

[[nodiscard]] DrawnBurst render(const Drawn& drawn, const Shot& shot = {});

}  // namespace enamel::test
