#include "pipeline/decode/steps/frame_gates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <span>
#include <vector>

#include "pipeline/decode/phase/frame_rows.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/decode/steps/chosen.hpp"
#include "pipeline/decode/steps/frame_gate_rows.hpp"

namespace enamel::pipeline {
namespace {

constexpr std::size_t kRowStep = 4;   ///< layout: gates on the whole burst need not ask every pixel
constexpr std::size_t kFrames = 4;    ///< layout: of a burst
constexpr float kSameSigmas = 2.83F;  ///< derived: 2 sigma of a difference, 2 sqrt(2)
constexpr double kSameShare = 0.954;  ///< derived: of two pictures of one scene, within 2 sigma

}  // namespace

double repeated_share(const BurstView& view, const PhaseMaps& maps, const NoiseModel& noise) {
  std::array<std::size_t, kFramePairs> same{};
  std::size_t seen = 0;
  const auto width = static_cast<std::size_t>(view.width);
  FrameRows rows;
  for (auto& row : rows) row.resize(width);
  for (std::size_t v = 0; v < static_cast<std::size_t>(view.height); v += kRowStep) {
    load_row(view, v, rows);
    const RepeatCount row = count_repeats_row({rows[0].data(), rows[1].data(), rows[2].data(), rows[3].data()}, maps,
                                              noise, kSameSigmas, v * width, width);
    seen += row.seen;
    for (std::size_t p = 0; p < kFramePairs; ++p) same[p] += row.same[p];
  }
  const std::size_t most = *std::max_element(same.begin(), same.end());
  return seen > 0 ? static_cast<double>(most) / static_cast<double>(seen) / kSameShare : 0;
}

namespace {

/// Frames of a burst that are one of another's, byte for byte; those of one level tell nothing.
std::size_t frames_shared(const BurstView& burst, const BurstView& before) noexcept {
  const auto is_flat = [](std::span<const std::uint8_t> f, std::size_t pixel) {
    return f.size() > pixel && std::memcmp(f.data(), f.data() + pixel, f.size() - pixel) == 0;
  };
  const std::size_t pixel = burst.bit_depth > 8 ? 2 : 1;
  std::size_t stale = 0;
  for (const auto& frame : burst.frames) {
    const bool seen = std::ranges::any_of(before.frames, [&](const auto& was) {
      return frame.size() == was.size() && !frame.empty() && std::memcmp(frame.data(), was.data(), frame.size()) == 0;
    });
    stale += seen && !is_flat(frame, pixel) ? 1U : 0U;
  }
  return stale;
}

}  // namespace

bool has_stale_frame(const BurstView& burst, const BurstView& before) noexcept {
  const std::size_t shared = frames_shared(burst, before);
  return shared > 0 && shared < burst.frames.size();
}

bool is_repeated(const BurstView& burst, const BurstView& before) noexcept {
  return frames_shared(burst, before) == burst.frames.size();
}

bool has_blank_frame(const BurstView& view, const PhaseMaps& maps, const NoiseModel& noise) {
  const auto width = static_cast<std::size_t>(view.width);
  FrameRows rows;
  for (auto& row : rows) row.resize(width);
  std::array<double, kFrames> sums{}, squares{};
  double seen = 0;
  for (std::size_t v = 0; v < static_cast<std::size_t>(view.height); v += 2 * kRowStep) {
    load_row(view, v, rows);
    const PixelReject* reject = &maps.reject[v * width];
    for (std::size_t u = 0; u < width; ++u) {
      if (reject[u] != PixelReject::kNone) continue;
      seen += 1;
      for (std::size_t k = 0; k < kFrames; ++k) {
        const auto x = static_cast<double>(rows[k][u]);
        sums[k] += x, squares[k] += x * x;
      }
    }
  }
  if (seen < 2) return false;
  bool blank = false, picture = false;
  for (std::size_t k = 0; k < kFrames; ++k) {
    const double mean = sums[k] / seen, variance = squares[k] / seen - mean * mean;
    const auto by_noise = static_cast<double>(noise.variance(static_cast<float>(mean)));
    blank = blank || variance < kBlankSigmas * kBlankSigmas * by_noise;
    picture = picture || variance > kPictureSigmas * kPictureSigmas * by_noise;
  }
  return blank && picture;
}

}  // namespace enamel::pipeline
