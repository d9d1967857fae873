// Breath on the probe's window: droplets take light out of the image, give part of it back as a veil, and blur the
// rest.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace enamel::twin {

struct FogConfig {
  double amount = 0;    ///< part of the light that droplets scatter when the fog is thickest, 0…1; 0: none
  double veil = 0.5;    ///< part of that which comes back, evenly over the image
  double blur_px = 2;   ///< Gaussian blur of the light that goes on, at amount 1
  double change_s = 0;  ///< how long it takes to come or to go, about; 0: it stays
};

/// Part of the light scattered at time t: config.amount, or less where the fog comes and goes. By seed.
[[nodiscard]] double fog_at(const FogConfig& config, double t_s, std::uint64_t seed);

/// Fog of that part on the mean light of a burst: every fringe keeps 1 - part of its modulation, before the blur.
void apply_fog(const FogConfig& config, double part, int width, int height, std::array<std::vector<float>, 4>& light);

}  // namespace enamel::twin
