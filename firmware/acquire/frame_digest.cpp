#include "firmware/acquire/frame_digest.hpp"

#include <cstring>
#include <span>
#include <vector>

#include "firmware/acquire/frame_pixels.hpp"

namespace enamel::fw {
namespace {

constexpr int kRowStep = 16;

std::uint64_t mix(std::uint64_t h, std::uint64_t v) {
  h = (h ^ v) * 0x9E3779B97F4A7C15ULL;
  return h ^ (h >> 29U);
}

std::uint64_t hash_row(std::uint64_t h, std::span<const std::uint8_t> row) {
  std::size_t i = 0;
  for (; i + 8 <= row.size(); i += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, row.data() + i, 8);
    h = mix(h, word);
  }
  for (; i < row.size(); ++i) h = mix(h, row[i]);
  return h;
}

std::uint64_t sum_row(std::span<const std::uint8_t> row, std::size_t bpp) {
  std::uint64_t sum = 0;
  if (bpp == 1) {
    for (const std::uint8_t v : row) sum += v;
  } else {
    for (std::size_t i = 0; i + 1 < row.size(); i += 2) sum += row[i] + 256U * row[i + 1];
  }
  return sum;
}

}  // namespace

FrameDigest digest(const CameraFrame& frame) {
  const std::size_t bpp = bytes_per_pixel(frame.bit_depth);
  std::vector<std::uint8_t> row(static_cast<std::size_t>(frame.width) * bpp);
  std::vector<std::uint8_t> begin(row.size());
  unpack_row(frame, 0, begin);
  std::uint64_t hash = 0;
  std::uint64_t sum = 0;
  std::uint64_t count = 0;
  bool blank = true;
  for (int y = frame.height > kRowStep / 2 ? kRowStep / 2 : 0; y < frame.height; y += kRowStep) {
    unpack_row(frame, y, row);
    hash = hash_row(hash, row);
    sum += sum_row(row, bpp);
    count += row.size() / bpp;
    // A row is blank when it equals itself shifted by one pixel and starts as the frame does.
    blank = blank && std::memcmp(row.data(), row.data() + bpp, row.size() - bpp) == 0 &&
            std::memcmp(row.data(), begin.data(), bpp) == 0;
  }
  FrameDigest d;
  if (count > 0) d.mean_dn = static_cast<double>(sum) / static_cast<double>(count);
  if (!blank) d.hash = hash;
  return d;
}

}  // namespace enamel::fw
