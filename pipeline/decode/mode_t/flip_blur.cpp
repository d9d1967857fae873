#include "pipeline/decode/mode_t/flip_blur.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/decode/mode_t/closure_rows.hpp"
#include "pipeline/decode/mode_t/flip_rows.hpp"
#include "pipeline/decode/phase/row_memory.hpp"

namespace enamel::pipeline {
namespace {

constexpr int kFlipRowStep = 4;  ///< layout: a quarter of the pixels gives a block's sigma to 5 %

struct FlipBlock {
  double rounding = 0, modulation = 0, noise = 0, pixels = 0;
};

}  // namespace

void fit_flip_blur(const KnownBurst& burst, const PolarityConfig& polarity_config, const FlipBlurConfig& config,
                   FlipBlur& out) {
  const PhaseMaps& maps = burst.maps;
  const int w = maps.phase_rad.width(), h = maps.phase_rad.height();
  const auto width = static_cast<std::size_t>(w);
  out.block_px = config.block_px;
  out.columns = (w + config.block_px - 1) / config.block_px;
  out.rows = (h + config.block_px - 1) / config.block_px;
  const auto columns = static_cast<std::size_t>(out.columns);
  std::vector<FlipBlock> blocks(columns * static_cast<std::size_t>(out.rows));
  FlipBlock all;
  ErrorRows rows(burst.errors, burst.black_dn, w);
  for (int row = 0; row < out.rows; ++row) {
    out.work.column_sums.assign(kFlipSums * width, 0.0F);
    float* sums = out.work.column_sums.data();
    for (int v = row * config.block_px; v < std::min(h, (row + 1) * config.block_px); v += kFlipRowStep)
      add_flip_row(maps, rows.at(burst.polarity, v), maps.phase_rad.index(0, v), width, sums);
    for (std::size_t u = 0; u < width; ++u) {
      FlipBlock& block =
          blocks[static_cast<std::size_t>(row) * columns + u / static_cast<std::size_t>(config.block_px)];
      for (FlipBlock* s : {&block, &all}) {
        s->rounding += static_cast<double>(sums[u]);
        s->modulation += static_cast<double>(sums[width + u]);
        s->noise += static_cast<double>(sums[2 * width + u]);
        s->pixels += static_cast<double>(sums[3 * width + u]);
      }
    }
  }
  // Noise of the other three frames turns the sign of a few pixels beside the flip, which takes sigma_phi^2 away.
  const double reach = static_cast<double>(polarity_config.flip_full_rad);
  const auto square = [&](const FlipBlock& s) {
    return (2 * reach * s.rounding + s.noise) / std::max(s.modulation, 1e-6);
  };
  const double least = static_cast<double>(config.least_sigma_rad);
  const double most = static_cast<double>(config.largest_sigma_rad);
  const double of_burst = all.pixels > static_cast<double>(config.prior_pixels) ? square(all) : most * most;
  out.burst_rad = static_cast<float>(std::clamp(std::sqrt(std::max(of_burst, 0.0)), least, most));
  out.sigma_rad.resize(blocks.size());
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const double n = blocks[k].pixels, prior = static_cast<double>(config.prior_pixels);
    const double own = n > 0 ? square(blocks[k]) : of_burst;
    const double sigma = std::sqrt(std::max((n * own + prior * of_burst) / (n + prior), 0.0));
    out.sigma_rad[k] = static_cast<float>(std::clamp(sigma, least, most));
  }
}

void finish_phase(const FinishInput& in, PhaseMaps& maps, PolarityMaps& polarity, const MovedBurst* moved) {
  const auto width = static_cast<std::size_t>(maps.phase_rad.width());
  GridRows sigma(in.blur.grid(), maps.phase_rad.width());
  ErrorRows rows(in.errors, in.noise.black_dn, maps.phase_rad.width());
  RowMemory squares(moved != nullptr ? width : 0, 0.0F), share(squares.size(), 0.0F);
  if (moved != nullptr) moved->misfit.start(maps.phase_rad.width(), maps.phase_rad.height());
  for (int v = 0; v < maps.phase_rad.height(); ++v) {
    const std::size_t at = maps.phase_rad.index(0, v);
    const RowErrors e = rows.at(polarity, v);
    rejoin_flip_row({sigma.row(v), e.rate, in.config.drop_sigmas, in.config.full_sigmas}, in.noise, at, width, maps,
                    polarity.weight);
    const PixelRow row = pixel_row(maps, e, at);
    if (moved == nullptr) {
      mid_burst_row(row, width, &maps.phase_rad[at], nullptr);
    } else {
      const ClosedRow closed{&maps.phase_rad[at], squares.data(), share.data()};
      closed_row(row, &maps.modulation_dn[at], &maps.reject[at], in.noise, width, closed);
      moved->torn.take_row(v, at, row, closed, &maps.reject[at]);
      moved->misfit.take_row(v, {squares.data(), share.data()});
    }
  }
  if (moved == nullptr) return;
  moved->torn.regain(moved->signs, in.noise, maps, polarity.wraps);
  moved->misfit.add_to(maps.sigma_rad, kPhaseOfClosure);
}

}  // namespace enamel::pipeline
