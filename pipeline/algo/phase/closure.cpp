#include "pipeline/algo/phase/closure.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "pipeline/algo/phase/closure_rows.hpp"
#include "pipeline/algo/phase/poly_trig.hpp"

namespace enamel::algo {
namespace {

using Sums = std::array<double, kClosureSums>;

struct Pair {
  double motion = 0, harmonic = 0;
};

/// (X'X + diag(p1, p2)) theta = X'y + diag(p1, p2) prior.
Pair solve(const double* s, double p1, double p2, Pair prior) {
  const double a = s[0] + p1, b = s[1], d = s[2] + p2;
  const double y1 = s[3] + p1 * prior.motion, y2 = s[4] + p2 * prior.harmonic;
  const double det = a * d - b * b;
  if (!(det > 1e-12 * a * d)) return prior;
  return {(d * y1 - b * y2) / det, (a * y2 - b * y1) / det};
}

struct Interpolation {
  std::size_t low = 0, high = 0;
  float share = 0;  ///< of `high`
};

Interpolation between_blocks(int pixel, int block_px, int blocks) {
  const float x = (static_cast<float>(pixel) + 0.5F) / static_cast<float>(block_px) - 0.5F;
  const int low = std::clamp(static_cast<int>(std::floor(x)), 0, blocks - 1);
  const int high = std::min(low + 1, blocks - 1);
  return {static_cast<std::size_t>(low), static_cast<std::size_t>(high),
          std::clamp(x - static_cast<float>(low), 0.0F, 1.0F)};
}

/// One row of interpolate_grid: ramps from each cell's middle to the next.
void interpolate_line(const std::vector<float>& line, std::size_t cell, std::size_t width, float* out) {
  const std::size_t half = cell / 2, last = line.size() - 1;
  std::fill(out, out + std::min(half, width), line.front());
  const float step = 1.0F / static_cast<float>(cell);
  for (std::size_t k = 0; k < last; ++k) {
    const std::size_t begin = k * cell + half;
    const std::size_t count = begin < width ? std::min(cell, width - begin) : 0;
    const float from = line[k], slope = (line[k + 1] - from) * step;
    float* __restrict o = out + begin;
    for (std::size_t j = 0; j < count; ++j) o[j] = from + slope * (static_cast<float>(static_cast<int>(j)) + 0.5F);
  }
  if (last * cell + half < width) std::fill(out + last * cell + half, out + width, line.back());
}

}  // namespace

void fit_closure(const PhaseMaps& maps, const PolarityMaps& polarity, const ClosureConfig& config, ClosureFit& out) {
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
      add_closure_row(maps, polarity, static_cast<std::size_t>(v) * width, width, config.max_residual,
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
  // A residual's variance is about 4 DN^2 at a typical sigma of 1 DN; only its ratio to the prior's matters.
  const double p1 = 4.0 / std::pow(static_cast<double>(config.motion_prior_rad), 2);
  const double p2 = 4.0 / std::pow(static_cast<double>(config.harmonic_prior), 2);
  out.block_motion_rad.resize(blocks);
  out.block_harmonic.resize(blocks);
  out.block_pixels.resize(blocks);
  for (std::size_t k = 0; k < blocks; ++k) {
    const Pair fit = solve(&out.work.block_sums[k * kClosureSums], p1, p2, burst);
    out.block_motion_rad[k] = static_cast<float>(fit.motion);
    out.block_harmonic[k] = static_cast<float>(fit.harmonic);
    out.block_pixels[k] = static_cast<float>(out.work.block_sums[k * kClosureSums + 5]);
  }
  for (Map<float>* map : {&out.pixel_motion_rad, &out.pixel_harmonic}) {
    if (map->width() != w || map->height() != h) *map = Map<float>(w, h);
  }
  interpolate_grid(out.block_motion_rad.data(), out.columns, out.rows, out.block_px, out.pixel_motion_rad);
  interpolate_grid(out.block_harmonic.data(), out.columns, out.rows, out.block_px, out.pixel_harmonic);
}

void MotionField::resize(int width, int height) {
  if (rate_rad.width() == width && rate_rad.height() == height) return;
  rate_rad = light = Map<float>(width, height);
}

void interpolate_grid(const float* nodes, int columns, int rows, int cell_px, Map<float>& out) {
  const int w = out.width(), h = out.height();
  const auto n = static_cast<std::size_t>(columns), cell = static_cast<std::size_t>(cell_px);
  std::vector<float> line(n);
  for (int v = 0; v < h; ++v) {
    const Interpolation down = between_blocks(v, cell_px, rows);
    for (std::size_t k = 0; k < n; ++k)
      line[k] = nodes[down.low * n + k] * (1 - down.share) + nodes[down.high * n + k] * down.share;
    interpolate_line(line, cell, static_cast<std::size_t>(w), &out(0, v));
  }
}

void correct_phase(const PolarityMaps& polarity, const MotionField* field, float black_dn, const ClosureFit& fit,
                   PhaseMaps& maps) {
  const auto width = static_cast<std::size_t>(maps.phase_rad.width());
  const Map<float>& rate = field != nullptr ? field->rate_rad : fit.pixel_motion_rad;
  const std::vector<float> none(width, 0.0F);
  for (std::size_t at = 0; at < maps.phase_rad.size(); at += width) {
    const float* light = field != nullptr ? &field->light[at] : none.data();
    correct_phase_row(maps, {&polarity.weight[at], &rate[at], &fit.pixel_harmonic[at], light}, black_dn, at, width,
                      &maps.phase_rad[at]);
  }
}

}  // namespace enamel::algo
