#include "tools/twin/app/burst_message.hpp"

#include <cmath>
#include <span>

#include "protocol/base/crc32.hpp"

namespace enamel::twin {
namespace {

struct Level {
  std::uint16_t mean_q4, saturated_permille;
};

Level level_of(const std::vector<std::uint8_t>& pixels, int bits) {
  const std::size_t step = bits > 8 ? 2 : 1, n = pixels.size() / step;
  const std::uint32_t top = (1U << static_cast<unsigned>(bits)) - 1U;
  std::uint64_t sum = 0, saturated = 0;
  for (std::size_t i = 0; i < pixels.size(); i += step) {
    const std::uint32_t v = step == 1 ? pixels[i] : pixels[i] + 256U * pixels[i + 1];
    sum += v;
    saturated += v == top ? 1U : 0U;
  }
  if (n == 0) return {0, 0};
  // mean_q4 counts 8-bit grey levels.
  const std::uint64_t mean_q4 = 16U * sum / n >> static_cast<unsigned>(bits > 8 ? bits - 8 : 0);
  return {static_cast<std::uint16_t>(mean_q4), static_cast<std::uint16_t>(1000U * saturated / n)};
}

}  // namespace

proto::Burst to_message(const fw::SimBurst& burst, std::uint32_t calib_crc32) {
  proto::Burst b;
  b.burst_seq = b.burst_index = burst.burst_index;
  b.t_first_exposure_ns = static_cast<std::uint64_t>(burst.t_exposure_ns[0]);
  b.width = static_cast<std::uint16_t>(burst.width);
  b.height = static_cast<std::uint16_t>(burst.height);
  b.bit_depth = static_cast<std::uint8_t>(burst.bit_depth);
  b.codec = burst.bit_depth > 8 ? proto::Codec::kRaw16 : proto::Codec::kRaw8;
  b.pattern_set = static_cast<std::uint8_t>(burst.pattern_set);
  b.frame_period_ns = static_cast<std::uint32_t>(burst.t_exposure_ns[1] - burst.t_exposure_ns[0]);
  b.illum_us = burst.exposure_us;
  b.temp_centi_c = static_cast<std::int16_t>(std::lround(burst.temp_c * 100));
  b.calib_crc32 = calib_crc32;
  b.meta.resize(proto::kFramesPerBurst);
  for (std::size_t k = 0; k < b.meta.size(); ++k) {
    const auto& pixels = burst.frames[k];
    proto::FrameMeta& m = b.meta[k];
    const Level level = level_of(pixels, burst.bit_depth);
    m.sensor_seq = static_cast<std::uint32_t>(burst.burst_index * proto::kFramesPerBurst + k);
    m.pattern_index = static_cast<std::uint8_t>(k);
    m.exposure_us = burst.exposure_us;
    m.t_strobe_ns = static_cast<std::uint64_t>(burst.t_exposure_ns[k]);
    m.t_sensor_ns = m.t_strobe_ns + std::uint64_t{burst.exposure_us} * 1000U;
    m.t_trig_rise_ns = m.t_strobe_ns;
    m.t_trig_fall_ns = m.t_sensor_ns;
    m.mean_q4 = level.mean_q4;
    m.saturated_permille = level.saturated_permille;
    m.offset = static_cast<std::uint32_t>(b.payload.size());
    m.length = static_cast<std::uint32_t>(pixels.size());
    b.payload.insert(b.payload.end(), pixels.begin(), pixels.end());
  }
  b.t_publish_ns = b.meta.back().t_sensor_ns;
  b.payload_crc32 = crc32(std::as_bytes(std::span(b.payload)));
  return b;
}

}  // namespace enamel::twin
