#include "protocol/types/burst.hpp"

#include "protocol/base/crc32.hpp"

namespace enamel::proto {

DeviceTime mid_burst(const Burst& burst) noexcept {
  if (burst.meta.size() < static_cast<std::size_t>(kFramesPerBurst)) return device_time(0);
  const FrameMeta& last = burst.meta[kFramesPerBurst - 1];
  const auto begin = static_cast<std::int64_t>(burst.meta[0].t_strobe_ns);
  const auto end = static_cast<std::int64_t>(last.t_strobe_ns) + std::int64_t{last.exposure_us} * 1000;
  return device_time(begin + (end - begin) / 2);
}

double frame_period_s(const Burst& burst) noexcept {
  if (burst.meta.size() < static_cast<std::size_t>(kFramesPerBurst)) return 0;
  return 1e-9 * static_cast<double>(burst.meta[kFramesPerBurst - 1].t_strobe_ns - burst.meta[0].t_strobe_ns) /
         (kFramesPerBurst - 1);
}

double exposure_spread_s2(const Burst& burst) noexcept {
  if (burst.meta.size() < static_cast<std::size_t>(kFramesPerBurst)) return 0;
  const std::int64_t middle = mid_burst(burst).time_since_epoch().count();
  double sum = 0;
  for (const FrameMeta& m : burst.meta) {
    const double exposure = 1e-6 * m.exposure_us;
    const double away = 1e-9 * static_cast<double>(static_cast<std::int64_t>(m.t_strobe_ns) - middle) + exposure / 2;
    sum += away * away + exposure * exposure / 12;
  }
  return sum / kFramesPerBurst;
}

bool is_consistent(const Burst& burst) noexcept {
  if (burst.width == 0 || burst.height == 0 || burst.frames != kFramesPerBurst) return false;
  if (burst.meta.size() != static_cast<std::size_t>(kFramesPerBurst)) return false;
  const bool one_byte = burst.codec == Codec::kRaw8 && burst.bit_depth == 8;
  const bool two_bytes = burst.codec == Codec::kRaw16 && burst.bit_depth > 8 && burst.bit_depth <= 16;
  if (!one_byte && !two_bytes) return false;
  const std::size_t frame_size = std::size_t{burst.width} * burst.height * (two_bytes ? 2U : 1U);
  if (burst.payload.size() != frame_size * kFramesPerBurst) return false;
  for (std::size_t k = 0; k < burst.meta.size(); ++k) {
    const FrameMeta& m = burst.meta[k];
    if (m.offset != k * frame_size || m.length != frame_size) return false;
    // Device times stay far below 2^62 ns (146 years); beyond that differences would overflow.
    if (m.t_strobe_ns >> 62U != 0) return false;
    if (k > 0 && m.t_strobe_ns <= burst.meta[k - 1].t_strobe_ns) return false;
  }
  return crc32(std::as_bytes(std::span(burst.payload))) == burst.payload_crc32;
}

std::span<const std::uint8_t> frame_bytes(const Burst& burst, int k) noexcept {
  if (k < 0 || static_cast<std::size_t>(k) >= burst.meta.size()) return {};
  const FrameMeta& m = burst.meta[static_cast<std::size_t>(k)];
  if (m.offset > burst.payload.size() || m.length > burst.payload.size() - m.offset) return {};
  return std::span(burst.payload).subspan(m.offset, m.length);
}

}  // namespace enamel::proto
