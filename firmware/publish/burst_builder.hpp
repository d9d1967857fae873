// An assembled burst in the form in which it travels. Pure.
#pragma once

#include <cstdint>

#include "firmware/acquire/acquisition.hpp"
#include "protocol/base/result.hpp"
#include "protocol/types/burst.hpp"

namespace enamel::fw {

/// Sensor noise: sigma(I)^2 = read^2 + I / gain, in DN. Serves the MOTION flag only.
struct SensorNoise {
  double gain_e_per_dn = 39.84;
  double read_noise_e = 5.0;
  double black_dn = 4.0;
};

struct FrameShape {
  int width = 0;
  int height = 0;
  int bit_depth = 8;
};

struct BurstBuilderConfig {
  std::uint32_t probe_id = 0;
  std::uint32_t calib_crc32 = 0;  ///< of the bytes of the rig file in force
  SensorNoise noise;
  double motion_sigmas = 4.0;         ///< above: kFlagMotion
  int saturated_permille = 5;         ///< above: kFlagSaturated
  double low_mean_above_dark_dn = 6;  ///< lit frames less than this above the sentinel, in 8-bit levels: kFlagLowMod
};

/// Pixels, metas and their sums; burst_seq and t_publish_ns stay 0, the publisher sets them. Flags never drop a burst.
/// Errors: kInternal when the frames are not whole or not of one size.
[[nodiscard]] Result<proto::Burst> build_burst(CapturedBurst captured, const BurstBuilderConfig& config);

/// Closure of the four frames on a 1/256 grid, as a multiple of its noise: median over pixels of the smaller of
/// |I0 + I2 - I1 - I3| / 2 sigma and |I1 - I3| / sqrt(2) sigma. Each is zero without motion in one of the two
/// polarities of a fringe, so the measure holds for plain and polarity-coded patterns alike.
[[nodiscard]] double closure_residual(const BurstPixels& pixels, const FrameShape& shape, const SensorNoise& noise);

}  // namespace enamel::fw
