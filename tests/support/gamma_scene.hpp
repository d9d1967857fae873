// Phase-shifted fringes of a projector with gamma, as pure signals: no geometry. For the study of ripple.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace enamel::test {

struct GammaScene {
  double gamma = 2.2;
  double noise = 0;  ///< sigma of a frame over the amplitude of its fundamental
  int width = 640, height = 480;
  double period_px = 27.3;
  std::uint64_t seed = 1;
};

struct GammaRipple {
  double three_step = 0, double_three_step = 0, four_step = 0;  ///< repeating part of the phase error, rad rms
  double one_term = 0;                                          ///< four-step less a1 sin 4phi (closure.hpp)
  double levelled = 0;                                          ///< four-step less phase_ripple.hpp's four terms
};

/// `bursts` bursts of a curved surface that moves from burst to burst; corrections are learnt from all of them and
/// judged on all. Through compute_phase and apply_polarity, 16 bit.
[[nodiscard]] GammaRipple measure_gamma(const GammaScene& scene, int bursts);

}  // namespace enamel::test
