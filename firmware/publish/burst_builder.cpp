#include "firmware/publish/burst_builder.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "protocol/base/crc32.hpp"

namespace enamel::fw {
namespace {

constexpr int kGrid = 16;  // every 16th pixel of every 16th row

double pixel(const BurstPixels& pixels, int bit_depth, std::size_t i) {
  return bit_depth <= 8 ? pixels.bytes[i] : pixels.bytes[2 * i] + 256.0 * pixels.bytes[2 * i + 1];
}

std::uint64_t ns(DeviceTime t) { return static_cast<std::uint64_t>(std::max<std::int64_t>(0, to_ns(t))); }

proto::FrameMeta meta_of(const LitFrame& lit, int k, const FrameLevels& levels, std::size_t length) {
  const CameraFrame& f = lit.frame;
  proto::FrameMeta m;
  m.sensor_seq = f.sensor_seq;
  m.pattern_index = static_cast<std::uint8_t>(k);
  m.exposure_us = f.exposure_us;
  m.analogue_gain_q8 = f.analogue_gain_q8;
  m.t_strobe_ns = ns(lit.t_strobe);
  m.t_sensor_ns = ns(f.t_sensor);
  m.t_trig_rise_ns = ns(lit.t_rise);
  m.t_trig_fall_ns = ns(lit.t_fall);
  m.mean_q4 = static_cast<std::uint16_t>(std::min(65535.0, std::floor(levels.mean_dn * 16.0 + 0.5)));
  m.saturated_permille =
      static_cast<std::uint16_t>(levels.count > 0 ? (levels.saturated * 1000 + levels.count / 2) / levels.count : 0);
  m.length = static_cast<std::uint32_t>(length);
  m.offset = static_cast<std::uint32_t>(static_cast<std::size_t>(k) * length);
  return m;
}

}  // namespace

double closure_residual(const BurstPixels& pixels, const FrameShape& shape, const SensorNoise& noise) {
  const auto width = static_cast<std::size_t>(shape.width);
  const std::size_t frame = width * static_cast<std::size_t>(shape.height);
  std::vector<double> residuals;
  for (int y = kGrid / 2; y < shape.height; y += kGrid) {
    for (int x = kGrid / 2; x < shape.width; x += kGrid) {
      const std::size_t i = static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
      std::array<double, 4> v{};
      for (std::size_t k = 0; k < 4; ++k) v[k] = pixel(pixels, shape.bit_depth, k * frame + i);
      const double mean = (v[0] + v[1] + v[2] + v[3]) / 4.0 - noise.black_dn;
      const double read_dn = noise.read_noise_e / noise.gain_e_per_dn;
      const double sigma = std::sqrt(read_dn * read_dn + std::max(0.0, mean) / noise.gain_e_per_dn + 1.0 / 12.0);
      const double plain = std::abs(v[0] + v[2] - v[1] - v[3]) / (2.0 * sigma);
      const double inverted = std::abs(v[1] - v[3]) / (std::sqrt(2.0) * sigma);
      residuals.push_back(std::min(plain, inverted));
    }
  }
  if (residuals.empty()) return 0;
  const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
  std::nth_element(residuals.begin(), middle, residuals.end());
  return *middle;
}

Result<proto::Burst> build_burst(CapturedBurst captured, const BurstBuilderConfig& config) {
  const AssembledBurst& in = captured.burst;
  const CameraFrame& first = in.frames[0].frame;
  const std::size_t length = frame_bytes(first.width, first.height, first.bit_depth);
  if (captured.pixels.bytes.size() != in.frames.size() * length) {
    return fail(ErrorCode::kInternal, "frames not whole or of different size");
  }
  const double step = static_cast<double>(1U << static_cast<unsigned>(std::max(0, first.bit_depth - 8)));
  proto::Burst out;
  out.probe_id = config.probe_id;
  out.session_id = captured.session.id.value;
  out.burst_index = in.burst_index;
  out.t_first_exposure_ns = ns(in.frames[0].t_strobe);
  out.width = static_cast<std::uint16_t>(first.width);
  out.height = static_cast<std::uint16_t>(first.height);
  out.bit_depth = static_cast<std::uint8_t>(first.bit_depth);
  out.codec = first.bit_depth > 8 ? proto::Codec::kRaw16 : proto::Codec::kRaw8;
  out.frame_period_ns = static_cast<std::uint32_t>(captured.frame_period.count());
  out.illum_us = static_cast<std::uint32_t>((in.frames[0].t_fall - in.frames[0].t_rise).count() / 1000);
  out.temp_centi_c = captured.temp_centi_c;
  out.pattern_set = captured.pattern_set;
  out.calib_crc32 = config.calib_crc32;
  const bool motion = closure_residual(captured.pixels, {first.width, first.height, first.bit_depth}, config.noise) >
                      config.motion_sigmas;
  for (int k = 0; k < proto::kFramesPerBurst; ++k) {
    const LitFrame& lit = in.frames[static_cast<std::size_t>(k)];
    const FrameLevels& levels = captured.pixels.levels[static_cast<std::size_t>(k)];
    proto::FrameMeta meta = meta_of(lit, k, levels, length);
    unsigned flags = motion ? unsigned{proto::kFlagMotion} : 0U;
    if (meta.saturated_permille > config.saturated_permille) flags |= proto::kFlagSaturated;
    if (levels.mean_dn < in.ambient_dn + config.low_mean_above_dark_dn * step) flags |= proto::kFlagLowMod;
    meta.quality_flags = static_cast<std::uint8_t>(flags);
    out.meta.push_back(meta);
  }
  out.payload = std::move(captured.pixels.bytes);
  out.payload_crc32 = crc32(std::as_bytes(std::span<const std::uint8_t>(out.payload)));
  return out;
}

}  // namespace enamel::fw
