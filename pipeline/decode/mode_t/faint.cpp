#include "pipeline/decode/mode_t/faint.hpp"

#include <cstddef>

#include "pipeline/types/simd.hpp"

namespace enamel::pipeline {

void admit_faint(const PhaseConfig& config, PhaseMaps& maps) {
  constexpr auto kNone = static_cast<int>(PixelReject::kNone), kNoisy = static_cast<int>(PixelReject::kNoisy);
  const float most = config.max_sigma_rad;
  const std::size_t count = maps.reject.size();
  const float* __restrict code = maps.code_dn.pixels().data(), * __restrict sigma = maps.sigma_rad.pixels().data();
  const float* __restrict cosine = maps.cosine_dn.pixels().data(), * __restrict sine = maps.sine_dn.pixels().data();
  PixelReject* __restrict reject = maps.reject.pixels().data();
  for (std::size_t i = 0; i < count; ++i) {
    const bool fine = (sigma[i] * fourth_frame_gain(cosine[i], sine[i]) < most) & (code[i] == code[i]);
    const auto was = static_cast<int>(reject[i]);
    reject[i] = static_cast<PixelReject>(((was == kNoisy) & fine) ? kNone : was);
  }
}

}  // namespace enamel::pipeline
