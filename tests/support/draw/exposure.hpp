// From rays to frames: the light of one frame on the pixel grid, and what the sensor makes of it.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/types/map.hpp"
#include "tests/support/draw/emission.hpp"
#include "tests/support/draw/tracer.hpp"

namespace enamel::test {

/// Ideal directions of all pixel centres, row major.
[[nodiscard]] std::vector<calib::PlanePoint> pixel_rays(const calib::LensValues& camera);

/// Everything of a drawn burst that its frames share. `drawn` must outlive it.
struct Stage {
  explicit Stage(const Drawn& of);

  const Drawn& drawn;
  std::unique_ptr<const SceneShape> shape;
  Emission emission;
  std::vector<calib::PlanePoint> rays;
};

struct FrameLight {
  Map<float> signal;      ///< share of full well, behind the lens's blur, without noise
  Map<double> column_px;  ///< of the projector at the middle of the exposure; NaN where not lit or beside an edge
};

/// The exposures of a burst whose middle is later_s after the drawn one's; frames that are not taken stay empty.
[[nodiscard]] std::array<FrameLight, 4> expose(const Stage& stage, double later_s, const std::array<bool, 4>& taken);

/// 8-bit picture; gain: of this exposure. noise: the same number gives the same noise.
[[nodiscard]] std::vector<std::uint8_t> read_out(const Drawn& drawn, const Map<float>& signal, double gain,
                                                 std::uint64_t noise);

}  // namespace enamel::test
