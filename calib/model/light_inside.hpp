// How much deeper than it is a tooth looks through this probe: section "light_inside" of rig.json, measured on a
// tooth-like ceramic (docs/calibration.md §8). Written by calib/io/rig_writer.hpp.
#pragma once

#include <array>

namespace enamel::calib {

/// Of what enamel's law takes off (docs/mouth.md) the shares that are right for this probe, of a surface across its
/// view: light and view meet it at other angles in other places. At the picture's edges and middle, [down][across]; a
/// parabola passes through each three.
struct LightInside {
  std::array<std::array<double, 3>, 3> of_enamel{{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}};
  double sigma = 0;  ///< of the shares' mean, one standard deviation
  int bursts = 0;    ///< that it was measured on
};

/// layout: what a share may be. Beyond it the surface is none that light enters.
inline constexpr double kLeastOfEnamel = 0.1, kMostOfEnamel = 10;

}  // namespace enamel::calib
