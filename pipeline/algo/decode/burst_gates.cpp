#include "pipeline/algo/decode/burst_gates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <span>
#include <vector>

#include "pipeline/algo/decode/gate_rows.hpp"
#include "pipeline/algo/decode/median.hpp"
#include "pipeline/algo/phase/frame_rows.hpp"
#include "pipeline/algo/phase/poly_trig.hpp"

namespace enamel::algo {
namespace {

constexpr float kTolerance = 0.25F;  ///< of B: motion of 0.1 rad a frame with a flip's blur stays below
constexpr float kNoiseSigmas = 6;    ///< 3 sigma of the residual, whose std is 2 sigma
constexpr std::size_t kRowStep = 4;  ///< gates on the whole burst need not ask every pixel
constexpr std::size_t kFrames = 4;
constexpr float kSameSigmas = 5.7F;  ///< 4 sigma of a difference

}  // namespace

double closure_share(const PhaseMaps& maps, const NoiseModel& noise) {
  std::size_t seen = 0, fits = 0;
  const auto width = static_cast<std::size_t>(maps.phase_rad.width());
  for (std::size_t at = 0; at < maps.phase_rad.size(); at += kRowStep * width) {
    const ClosureCount row = count_closure_row(maps, noise, kTolerance, kNoiseSigmas, at, width);
    seen += row.seen;
    fits += row.fits;
  }
  return seen > 0 ? static_cast<double>(fits) / static_cast<double>(seen) : 0;
}

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
  return seen > 0 ? static_cast<double>(most) / static_cast<double>(seen) : 0;
}

bool has_stale_frame(const BurstView& burst, const BurstView& before) noexcept {
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
  return stale > 0 && stale < burst.frames.size();
}

bool has_blank_frame(const BurstView& view, const PhaseMaps& maps, const NoiseModel& noise) {
  constexpr double kBlankSigmas = 2, kPictureSigmas = 6;
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

OddFrame find_odd_frame(const PhaseMaps& maps, const PolarityMaps& polarity, const BurstErrors& errors, float black_dn,
                        int block_px) {
  const auto width = static_cast<std::size_t>(maps.phase_rad.width()), block = static_cast<std::size_t>(block_px);
  ErrorRows rows(errors, black_dn, maps.phase_rad.width());
  std::vector<float> shifts, levels, columns(kOddSums * width);
  for (int top = 0; top < maps.phase_rad.height(); top += block_px) {
    std::fill(columns.begin(), columns.end(), 0.0F);
    const int end = std::min(top + block_px, maps.phase_rad.height());
    for (int v = top; v < end; v += static_cast<int>(kRowStep)) {
      add_odd_row(maps, rows.at(polarity, v), maps.phase_rad.index(0, v), width, columns.data());
    }
    for (std::size_t u = 0; u < width; u += block) {
      std::array<float, kOddSums> sums{};  // both, its energy, level, its energy
      for (std::size_t k = 0; k < kOddSums; ++k) {
        const auto first = columns.begin() + static_cast<std::ptrdiff_t>(k * width + u);
        sums[k] = std::accumulate(first, first + static_cast<std::ptrdiff_t>(std::min(block, width - u)), 0.0F);
      }
      if (sums[1] > 0) shifts.push_back(2 * std::abs(sums[0] / sums[1]));
      if (sums[3] > 0) levels.push_back(2 * std::abs(sums[2] / sums[3]));
    }
  }
  return {median(shifts), median(levels)};
}

double direction_share(const PhaseMaps& maps, const Carrier& carrier) {
  std::size_t seen = 0, follows = 0;
  const auto width = static_cast<std::size_t>(maps.phase_rad.width());
  for (std::size_t at = 0; at < maps.phase_rad.size(); at += width) {
    const float* __restrict p = &maps.phase_rad[at], * __restrict c = carrier.phase_mid_rad + at;
    const PixelReject* __restrict reject = &maps.reject[at];
    unsigned row_seen = 0, row_follows = 0;
    for (std::size_t u = 0; u + 1 < width; ++u) {
      const unsigned valid = static_cast<unsigned>(reject[u] == PixelReject::kNone) &
                             static_cast<unsigned>(reject[u + 1] == PixelReject::kNone);
      row_seen += valid;
      row_follows += valid & static_cast<unsigned>(wrap_once(p[u + 1] - p[u]) * (c[u + 1] - c[u]) > 0);
    }
    seen += row_seen;
    follows += row_follows;
  }
  return seen > 0 ? static_cast<double>(follows) / static_cast<double>(seen) : 0;
}

}  // namespace enamel::algo
