// Means over blocks and surroundings of a picture parts of which are unknown. Private to register/feature.
#pragma once

#include <cstdint>

#include "pipeline/register/feature/feature_images.hpp"
#include "pipeline/types/map.hpp"
#include "pipeline/types/patch.hpp"

namespace enamel::pipeline {

/// A value and how much of it is known: masked means are value/weight after the same sums over both.
struct Masked {
  Map<double> value;
  Map<double> weight;
};

/// Of `step` x `step` pixels; NaN is unknown. Weights are 1 or 0.
[[nodiscard]] Masked block_means(const Map<float>& in, int step);
/// Two box passes each way: a triangle window whose full width at half maximum is the box. Weights are sums.
[[nodiscard]] Masked lowpass(const Masked& in, int radius);

/// Of blocks and surroundings, as the configuration asks for.
[[nodiscard]] int block_px(const SurfacePatch& patch, const ImageConfig& config);
[[nodiscard]] int lowpass_radius(int step, double px_per_mm, const ImageConfig& config);
/// Of its surroundings; below a few DN there is noise only.
[[nodiscard]] double brightness_of(double dn, double around_dn);
/// -1 … 1 to 1 … 255, 128 in the middle.
[[nodiscard]] std::uint8_t to_grey(double x);

}  // namespace enamel::pipeline
