#include "pipeline/decode/mode_t/closure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "pipeline/decode/mode_t/closure_rows.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"

namespace enamel::pipeline {
namespace {

using Sums = std::array<double, kClosureSums>;

struct Pair {
  double motion = 0, harmonic = 0;
};

constexpr double kVarianceOfResidual = 4;  ///< derived: in those of one frame, of which four are summed

/// (X'X + diag(p1, p2)) theta = X'y + diag(p1, p2) prior.
Pair solve(const double* s, double p1, double p2, Pair prior) {
  const double a = s[0] + p1, b = s[1], d = s[2] + p2;
  const double y1 = s[3] + p1 * prior.motion, y2 = s[4] + p2 * prior.harmonic;
  const double det = a * d - b * b;
  if (!(det > 1e-12 * a * d)) return prior;
  return {(d * y1 - b * y2) / det, (a * y2 - b * y1) / det};
}

/// Of the motion that solve() finds.
double sigma_of_motion(const double* s, double p1, double p2) {
  const double a = s[0] + p1, d = s[2] + p2, det = a * d - s[1] * s[1];
  if (!(det > 1e-12 * a * d) || !(s[0] > 0)) return std::numeric_limits<double>::infinity();
  return std::sqrt(kVarianceOfResidual * s[5] / s[0] * d / det);
}

}  // namespace

void fit_closure(const PhaseMaps& maps, const PolarityMaps& polarity, const NoiseModel& noise,
                 const ClosureConfig& config, ClosureFit& out) {
  const int w = maps.phase_rad.width(), h = maps.phase_rad.height();
  const auto width = static_cast<std::size_t>(w);
  out.block_px = config.block_px;
  out.columns = (w + config.block_px - 1) / config.block_px;
  out.rows = (h + config.block_px - 1) / config.block_px;
  const std::size_t blocks = static_cast<std::size_t>(out.columns) * static_cast<std::size_t>(out.rows);
  out.work.block_sums.assign(blocks * kClosureSums, 0.0);
  Sums all{};
  for (int br = 0; br < out.rows; ++br) {
    out.work.column_sums.assign(kClosureSums * width, 0.0F);
    for (int v = br * config.block_px; v < std::min(h, (br + 1) * config.block_px); ++v) {
      add_closure_row(maps, polarity, noise, static_cast<std::size_t>(v) * width, width, config.max_residual,
                      out.work.column_sums.data());
    }
    for (std::size_t u = 0; u < width; ++u) {
      const std::size_t block =
          static_cast<std::size_t>(br * out.columns) + u / static_cast<std::size_t>(config.block_px);
      for (std::size_t k = 0; k < kClosureSums; ++k) {
        const auto value = static_cast<double>(out.work.column_sums[k * width + u]);
        out.work.block_sums[block * kClosureSums + k] += value;
        all[k] += value;
      }
    }
  }
  const Pair burst = solve(all.data(), 1e-3, 1e-3, {});
  out.motion_rad = static_cast<float>(burst.motion);
  out.harmonic = static_cast<float>(burst.harmonic);
  // At a typical sigma of 1 DN; only the ratio of the residual's variance to the prior's matters.
  const double p1 = kVarianceOfResidual / std::pow(static_cast<double>(config.motion_prior_rad), 2);
  const double p2 = kVarianceOfResidual / std::pow(static_cast<double>(config.harmonic_prior), 2);
  out.block_motion_rad.resize(blocks);
  out.block_harmonic.resize(blocks);
  out.block_sigma_rad.resize(blocks);
  for (std::size_t k = 0; k < blocks; ++k) {
    const double* sums = &out.work.block_sums[k * kClosureSums];
    const Pair fit = solve(sums, p1, p2, burst);
    out.block_motion_rad[k] = static_cast<float>(fit.motion);
    out.block_harmonic[k] = static_cast<float>(fit.harmonic);
    out.block_sigma_rad[k] = static_cast<float>(sigma_of_motion(sums, p1, p2));
  }
}

void correct_phase(const PolarityMaps& polarity, const BurstErrors& errors, float black_dn, PhaseMaps& maps) {
  const auto width = static_cast<std::size_t>(maps.phase_rad.width());
  ErrorRows rows(errors, black_dn, maps.phase_rad.width());
  for (int v = 0; v < maps.phase_rad.height(); ++v) {
    const std::size_t at = maps.phase_rad.index(0, v);
    mid_burst_row(pixel_row(maps, rows.at(polarity, v), at), width, &maps.phase_rad[at], nullptr);
  }
}

}  // namespace enamel::pipeline
