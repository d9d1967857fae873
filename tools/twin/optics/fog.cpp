#include "tools/twin/optics/fog.hpp"

#include <algorithm>
#include <numeric>

#include "tools/twin/optics/sensor.hpp"
#include "tools/twin/surface/noise.hpp"

namespace enamel::twin {

double fog_at(const FogConfig& config, double t_s, std::uint64_t seed) {
  if (config.change_s <= 0) return config.amount;
  constexpr std::uint64_t kStream = 0x666F67;
  constexpr double kGain = 1.5;  // most of the noise lies within two thirds of its range: clear and thickest occur
  const double wave = value_noise({t_s / config.change_s, 0.5, 0.5}, mix64(seed ^ kStream));
  return config.amount * std::clamp(0.5 + 0.5 * kGain * wave, 0.0, 1.0);
}

void apply_fog(const FogConfig& config, double part, int width, int height, std::array<std::vector<float>, 4>& light) {
  if (part <= 0) return;
  for (auto& image : light) {
    const double mean = std::accumulate(image.begin(), image.end(), 0.0) / static_cast<double>(image.size());
    apply_psf(image, width, height, config.blur_px * part);
    const auto veil = static_cast<float>(part * config.veil * mean), kept = static_cast<float>(1 - part);
    for (float& v : image) v = kept * v + veil;
  }
}

}  // namespace enamel::twin
