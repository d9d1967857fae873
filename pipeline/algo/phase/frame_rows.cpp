#include "pipeline/algo/phase/frame_rows.hpp"

#include <cstring>

#include "pipeline/algo/phase/poly_trig.hpp"

namespace enamel::algo {

void load_row(const BurstView& view, std::size_t row, FrameRows& rows) {
  const auto width = static_cast<std::size_t>(view.width);
  for (std::size_t k = 0; k < 4; ++k) {
    float* out = rows[k].data();
    if (view.bit_depth == 8) {
      const std::uint8_t* in = view.frames[k].data() + row * width;
      for (std::size_t u = 0; u < width; ++u) out[u] = in[u];
    } else {
      const std::uint8_t* in = view.frames[k].data() + 2 * row * width;
      for (std::size_t u = 0; u < width; ++u) {
        std::uint16_t value = 0;
        std::memcpy(&value, in + 2 * u, 2);
        out[u] = value;
      }
    }
  }
}

void mask_row(const MaskFrames& frames, std::size_t width, const NoiseModel& noise, const PhaseConfig& config,
              const float* sigma, PixelReject* reject) {
  const float* __restrict i0 = frames.a;
  const float* __restrict i1 = frames.b;
  const float* __restrict i2 = frames.c;
  const float saturated_dn = config.saturation * noise.full_scale_dn;
  const float clip_dn = noise.black_dn > 0 ? 0.5F : -1.0F;  // a pedestal exists so that dark pixels are not clipped
  const float dark_dn = noise.black_dn + config.dark_sigmas * root(noise.floor_dn2);
  for (std::size_t u = 0; u < width; ++u) {
    const float high = i0[u] > i1[u] ? (i0[u] > i2[u] ? i0[u] : i2[u]) : (i1[u] > i2[u] ? i1[u] : i2[u]);
    const float low = i0[u] < i1[u] ? (i0[u] < i2[u] ? i0[u] : i2[u]) : (i1[u] < i2[u] ? i1[u] : i2[u]);
    int why =
        sigma[u] < config.max_sigma_rad ? static_cast<int>(PixelReject::kNone) : static_cast<int>(PixelReject::kNoisy);
    why = high >= saturated_dn ? static_cast<int>(PixelReject::kSaturated) : why;
    why = high <= dark_dn ? static_cast<int>(PixelReject::kDark) : why;
    why = low < clip_dn ? static_cast<int>(PixelReject::kDark) : why;
    reject[u] = static_cast<PixelReject>(why);
  }
}

}  // namespace enamel::algo
