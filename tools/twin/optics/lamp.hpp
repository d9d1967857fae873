// The lamp over the chair: light that is not the projector's, from one side, perhaps flickering with the mains.
#pragma once

#include <Eigen/Core>
#include <array>

namespace enamel::twin {

struct LampConfig {
  double strength = 0;                              ///< full-well fraction on albedo 1 facing the lamp; 0: off
  std::array<double, 3> direction{0.4, -0.3, 1.0};  ///< towards the lamp, model coordinates, any length
  double flicker = 0;                               ///< relative swing of its light, 0…1
  double flicker_hz = 100;                          ///< twice the mains
};

/// Lambert, without shadows, whatever the distance. Full-well fraction.
[[nodiscard]] double lamp_light(const LampConfig& config, const Eigen::Vector3d& normal, float albedo);

/// Mean of 1 + flicker cos(2 pi f t) over an exposure that starts at start_s.
[[nodiscard]] double lamp_factor(const LampConfig& config, double start_s, double exposure_s);

}  // namespace enamel::twin
