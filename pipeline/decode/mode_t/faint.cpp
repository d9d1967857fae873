#include "pipeline/decode/mode_t/faint.hpp"

#include <cmath>
#include <cstddef>

namespace enamel::pipeline {

void admit_faint(const PhaseConfig& config, PhaseMaps& maps) {
  for (std::size_t i = 0; i < maps.reject.size(); ++i) {
    if (maps.reject[i] != PixelReject::kNoisy || std::isnan(maps.code_dn[i])) continue;  // few are noisy
    const float by_four_rad = maps.sigma_rad[i] * fourth_frame_gain(maps.cosine_dn[i], maps.sine_dn[i]);
    if (by_four_rad < config.max_sigma_rad) maps.reject[i] = PixelReject::kNone;
  }
}

}  // namespace enamel::pipeline
