#include "firmware/device/sim/sim_frame.hpp"

#include <string>

namespace enamel::fw {

std::size_t pixel_bytes(int width, int height, int bit_depth) {
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * (bit_depth > 8 ? 2U : 1U);
}

std::vector<std::uint8_t> blank_frame(const CameraMode& mode, std::uint8_t dn8) {
  std::vector<std::uint8_t> pixels(pixel_bytes(mode.width, mode.height, mode.bit_depth), dn8);
  if (mode.bit_depth <= 8) return pixels;
  const unsigned level = unsigned{dn8} << static_cast<unsigned>(mode.bit_depth - 8);
  for (std::size_t i = 0; i + 1 < pixels.size(); i += 2) {
    pixels[i] = static_cast<std::uint8_t>(level & 0xFFU);
    pixels[i + 1] = static_cast<std::uint8_t>(level >> 8U);
  }
  return pixels;
}

std::int64_t frame_period_ns(const SimBurst& burst) { return (burst.t_exposure_ns[3] - burst.t_exposure_ns[0]) / 3; }

Result<void> check_exposure(const SimBurst& burst) {
  const std::int64_t period = frame_period_ns(burst), exposure = std::int64_t{burst.exposure_us} * 1000;
  if (period > 0 && period <= 1'000'000'000 && exposure > 0 && exposure <= period) return {};
  return fail(ErrorCode::kConfigValue, "burst " + std::to_string(burst.burst_index) + ": frame period " +
                                           std::to_string(period) + " ns, exposure " + std::to_string(exposure) +
                                           " ns");
}

}  // namespace enamel::fw
