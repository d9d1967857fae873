#include "firmware/acquire/frame_pixels.hpp"

#include <algorithm>
#include <cstring>

namespace enamel::fw {
namespace {

void unpack_ten(std::span<const std::uint8_t> packed, std::span<std::uint8_t> out) noexcept {
  for (std::size_t i = 0; 2 * i < out.size(); ++i) {
    const std::size_t group = 5 * (i / 4), place = i % 4;
    // A last group that is not full still carries its low bits in the byte behind its pixels.
    const std::size_t low_at = std::min(group + 4, packed.size() - 1);
    const unsigned low = (unsigned{packed[low_at]} >> (2 * place)) & 3U;
    const unsigned value = (unsigned{packed[group + place]} << 2U) | low;
    out[2 * i] = static_cast<std::uint8_t>(value & 0xFFU);
    out[2 * i + 1] = static_cast<std::uint8_t>(value >> 8U);
  }
}

void add_levels(std::span<const std::uint8_t> row, int bit_depth, std::uint64_t& sum, FrameLevels& levels) noexcept {
  const unsigned full = (1U << static_cast<unsigned>(bit_depth)) - 1U;
  if (bytes_per_pixel(bit_depth) == 1) {
    levels.count += row.size();
    for (const std::uint8_t v : row) {
      sum += v;
      levels.saturated += v >= full ? 1U : 0U;
    }
    return;
  }
  levels.count += row.size() / 2;
  for (std::size_t i = 0; i + 1 < row.size(); i += 2) {
    const unsigned v = row[i] + 256U * row[i + 1];
    sum += v;
    levels.saturated += v >= full ? 1U : 0U;
  }
}

}  // namespace

bool is_whole(const CameraFrame& frame) noexcept {
  const bool wide = frame.format != PixelFormat::kRaw8;
  if (frame.width < 1 || wide != (frame.bit_depth > 8)) return false;
  if (frame.format == PixelFormat::kRaw10Packed && frame.bit_depth != 10) return false;
  return frame.pixels.holds(row_bytes(frame.format, frame.width), frame.height);
}

void unpack_row(const CameraFrame& frame, int y, std::span<std::uint8_t> out) noexcept {
  const auto row = frame.pixels.row(row_bytes(frame.format, frame.width), y);
  if (frame.format == PixelFormat::kRaw10Packed) return unpack_ten(row, out);
  std::memcpy(out.data(), row.data(), out.size());
}

BurstPixels take_pixels(AssembledBurst& burst) {
  const CameraFrame& first = burst.frames[0].frame;
  const std::size_t row = static_cast<std::size_t>(first.width) * bytes_per_pixel(first.bit_depth);
  for (const LitFrame& lit : burst.frames) {
    const CameraFrame& f = lit.frame;
    const bool same = f.width == first.width && f.height == first.height && f.bit_depth == first.bit_depth;
    if (!same || !is_whole(f)) return {};
  }
  BurstPixels taken;
  taken.bytes.resize(burst.frames.size() * row * static_cast<std::size_t>(first.height));
  std::span<std::uint8_t> left(taken.bytes);
  for (std::size_t k = 0; k < burst.frames.size(); ++k) {
    CameraFrame& frame = burst.frames[k].frame;
    std::uint64_t sum = 0;
    for (int y = 0; y < frame.height; ++y, left = left.subspan(row)) {
      unpack_row(frame, y, left.first(row));
      add_levels(left.first(row), frame.bit_depth, sum, taken.levels[k]);
    }
    taken.levels[k].mean_dn = static_cast<double>(sum) / static_cast<double>(taken.levels[k].count);
    frame.pixels.give_back();
  }
  return taken;
}

}  // namespace enamel::fw
