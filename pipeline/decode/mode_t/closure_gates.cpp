#include "pipeline/decode/mode_t/closure_gates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "pipeline/decode/mode_t/chosen.hpp"
#include "pipeline/decode/mode_t/closure_gate_rows.hpp"
#include "pipeline/decode/phase/median.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"

namespace enamel::pipeline {
namespace {

constexpr float kNoiseSigmas = 6;    ///< derived: 3 sigma of the residual, whose std is 2 sigma
constexpr float kResidualSigma = 2;  ///< derived: std of I0 + I2 - I1 - I3 over that of a frame
constexpr std::size_t kRowStep = 4;  ///< layout: gates on the whole burst need not ask every pixel

}  // namespace

double closure_share(const PhaseMaps& maps, const NoiseModel& noise) {
  std::size_t seen = 0, fits = 0;
  const auto width = static_cast<std::size_t>(maps.phase_rad.width());
  for (std::size_t at = 0; at < maps.phase_rad.size(); at += kRowStep * width) {
    const ClosureCount row = count_closure_row(maps, noise, kClosureTolerance, kNoiseSigmas, at, width);
    seen += row.seen;
    fits += row.fits;
  }
  return seen > 0 ? static_cast<double>(fits) / static_cast<double>(seen) : 0;
}

OddFrame find_odd_frame(const KnownBurst& burst, const NoiseModel& noise, int block_px) {
  const PhaseMaps& maps = burst.maps;
  const auto width = static_cast<std::size_t>(maps.phase_rad.width()), block = static_cast<std::size_t>(block_px);
  ErrorRows rows(burst.errors, burst.black_dn, maps.phase_rad.width());
  std::vector<float> shifts, levels, sigmas, steps, columns(kOddSums * width);
  for (int top = 0; top < maps.phase_rad.height(); top += block_px) {
    std::fill(columns.begin(), columns.end(), 0.0F);
    const int end = std::min(top + block_px, maps.phase_rad.height());
    for (int v = top; v < end; v += static_cast<int>(kRowStep)) {
      add_odd_row(maps, rows.at(burst.polarity, v), maps.phase_rad.index(0, v), width, columns.data());
    }
    for (std::size_t u = 0; u < width; u += block) {
      std::array<float, kOddSums> sums{};  // as kOddSums lays them out
      for (std::size_t k = 0; k < kOddSums; ++k) {
        const auto first = columns.begin() + static_cast<std::ptrdiff_t>(k * width + u);
        sums[k] = std::accumulate(first, first + static_cast<std::ptrdiff_t>(std::min(block, width - u)), 0.0F);
      }
      if (sums[1] > 0) {
        const int middle = std::min(static_cast<int>(u) + block_px / 2, maps.phase_rad.width() - 1);
        const float variance = noise.variance(maps.mean_dn(middle, (top + end) / 2));
        shifts.push_back(2 * std::abs(sums[0] / sums[1]));
        sigmas.push_back(2 * kResidualSigma * root(variance / sums[1]));
      }
      if (sums[5] > 0) steps.push_back(sums[4] / sums[5]);
      if (sums[3] > 0) levels.push_back(2 * std::abs(sums[2] / sums[3]));
    }
  }
  const std::size_t blocks = shifts.size();
  return {median(shifts), median(levels), median(sigmas), std::abs(median(steps)), blocks};
}

}  // namespace enamel::pipeline
