#include "pipeline/algo/decode/burst_gates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "pipeline/algo/phase/frame_rows.hpp"
#include "pipeline/algo/phase/poly_trig.hpp"

namespace enamel::algo {
namespace {

constexpr float kTolerance = 0.25F;  ///< of B: motion of 0.1 rad a frame with a flip's blur stays below
constexpr float kNoiseSigmas = 6;    ///< 3 sigma of the residual, whose std is 2 sigma
constexpr std::size_t kRowStep = 4;  ///< gates on the whole burst need not ask every pixel
constexpr float kSameSigmas = 5.7F;  ///< 4 sigma of a difference
constexpr std::array<std::array<std::size_t, 2>, 6> kFramePairs = {{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

/// Unexplained residual of a block, projected: on S + C where b = +1, on B where b = -1.
struct BlockRest {
  float both = 0, both_energy = 0, level = 0, level_energy = 0;
};

float median(std::vector<float>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

double closure_share(const PhaseMaps& maps, const NoiseModel& noise) {
  std::size_t seen = 0, fits = 0;
  const NoiseModel model = noise;
  const auto width = static_cast<std::size_t>(maps.phase_rad.width());
  for (std::size_t at = 0; at < maps.phase_rad.size(); at += width) {
    const float* __restrict d = &maps.code_dn[at], * __restrict s = &maps.sine_dn[at];
    const float* __restrict b = &maps.modulation_dn[at], * __restrict a = &maps.mean_dn[at];
    const PixelReject* __restrict reject = &maps.reject[at];
    unsigned row_seen = 0, row_fits = 0;
    for (std::size_t u = 0; u < width; ++u) {
      const float gap = std::abs(std::abs(d[u]) - std::abs(s[u]));
      const float limit = kTolerance * b[u] + kNoiseSigmas * root(model.variance(a[u]));
      const unsigned counted =
          static_cast<unsigned>(reject[u] == PixelReject::kNone) & static_cast<unsigned>(d[u] == d[u]);
      row_seen += counted;
      row_fits += counted & static_cast<unsigned>(gap < limit);
    }
    seen += row_seen;
    fits += row_fits;
  }
  return seen > 0 ? static_cast<double>(fits) / static_cast<double>(seen) : 0;
}

double repeated_share(const BurstView& view, const PhaseMaps& maps, const NoiseModel& noise) {
  std::array<std::size_t, kFramePairs.size()> same{};
  std::size_t seen = 0;
  const auto width = static_cast<std::size_t>(view.width);
  FrameRows rows;
  for (auto& row : rows) row.resize(width);
  for (std::size_t v = 0; v < static_cast<std::size_t>(view.height); v += kRowStep) {
    load_row(view, v, rows);
    const PixelReject* reject = &maps.reject[v * width];
    for (std::size_t u = 0; u < width; ++u) {
      if (reject[u] != PixelReject::kNone) continue;
      ++seen;
      const float variance = noise.variance(maps.mean_dn[v * width + u]);
      for (std::size_t p = 0; p < kFramePairs.size(); ++p) {
        const float d = rows[kFramePairs[p][0]][u] - rows[kFramePairs[p][1]][u];
        same[p] += d * d < kSameSigmas * kSameSigmas * variance ? 1U : 0U;
      }
    }
  }
  const std::size_t most = *std::max_element(same.begin(), same.end());
  return seen > 0 ? static_cast<double>(most) / static_cast<double>(seen) : 0;
}

OddFrame find_odd_frame(const PhaseMaps& maps, const PolarityMaps& polarity, const ClosureFit& fit,
                        const MotionField* field) {
  std::vector<BlockRest> blocks(fit.block_motion_rad.size());
  const int width = maps.phase_rad.width();
  for (int v = 0; v < maps.phase_rad.height(); v += static_cast<int>(kRowStep)) {
    for (int u = 0; u < width; ++u) {
      const std::size_t i = maps.phase_rad.index(u, v);
      const float w = polarity.weight[i], r = maps.code_dn[i];
      if (maps.reject[i] != PixelReject::kNone || !(std::abs(w) > 0.999F) || !(r == r)) continue;
      const float c = maps.cosine_dn[i], s = maps.sine_dn[i], b = maps.modulation_dn[i];
      const float e = field != nullptr ? field->rate_rad[i] : fit.pixel_motion_rad[i];
      const float light = field != nullptr ? 2 * b * field->light[i] : 0;
      BlockRest& block = blocks[fit.block_at(u, v)];
      if (w > 0) {
        const float model = 2 * e * (1 + e) * (s - c) + 4 * fit.pixel_harmonic[i] * (c - s) * (c + s) / b - light;
        block.both += (r - model) * (s + c);
        block.both_energy += (s + c) * (s + c);
      } else {
        block.level += r + 2 * e * (c - e * s) - light;
        block.level_energy += b;
      }
    }
  }
  std::vector<float> shifts, levels;
  for (const BlockRest& block : blocks) {
    if (block.both_energy > 0) shifts.push_back(2 * std::abs(block.both / block.both_energy));
    if (block.level_energy > 0) levels.push_back(2 * std::abs(block.level / block.level_energy));
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

float max_code_turn_rad(double code_ratio) { return static_cast<float>(std::numbers::pi / (3 * code_ratio)); }

}  // namespace enamel::algo
