#include "tools/twin/optics/lamp.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace enamel::twin {

double lamp_light(const LampConfig& config, const Eigen::Vector3d& normal, float albedo) {
  if (config.strength == 0) return 0;
  const Eigen::Vector3d to_lamp(config.direction[0], config.direction[1], config.direction[2]);
  return config.strength * static_cast<double>(albedo) * std::max(0.0, normal.dot(to_lamp) / to_lamp.norm());
}

double lamp_factor(const LampConfig& config, double start_s, double exposure_s) {
  const double omega = 2 * std::numbers::pi * config.flicker_hz;
  const double swing = std::sin(omega * (start_s + exposure_s)) - std::sin(omega * start_s);
  return 1 + config.flicker * swing / (omega * exposure_s);
}

}  // namespace enamel::twin
