#include "pipeline/decode/mode_m/micro_refit.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "pipeline/decode/mode_m/micro_join.hpp"
#include "pipeline/decode/mode_m/micro_spans.hpp"
#include "pipeline/decode/phase/block_fit.hpp"

namespace enamel::pipeline {
namespace {

struct Step {
  double gain = 0, motion = 0;
};

/// Least squares of sums {gg, gm, mm, gr, mr}, held to 0 by the precisions given.
Step solve(const double* s, double gain_precision, double motion_precision) {
  const double gg = s[0] + gain_precision, mm = s[2] + motion_precision, det = gg * mm - s[1] * s[1];
  if (!(det > 1e-12 * gg * mm)) return {};
  return {(-s[3] * mm + s[4] * s[1]) / det, (-s[4] * gg + s[3] * s[1]) / det};
}

class Fitter {
 public:
  Fitter(const MicroBurst& burst, const MicroRefitConfig& config, MicroMotion& out)
      : burst_(burst), config_(config), out_(out) {
    columns_ = (burst.maps.phase_rad.width() + config.block_px - 1) / config.block_px;
    rows_ = (burst.maps.phase_rad.height() + config.block_px - 1) / config.block_px;
  }

  /// All passes but the last move every block with the burst: its estimate must rest on residuals about itself.
  void run() {
    reset();
    for (int pass = 0; pass < config_.passes; ++pass) {
      sum(config_.row_step << (config_.passes - 1 - pass));
      advance_burst();
      if (pass + 1 < config_.passes) {
        std::fill(out_.block_gain.begin(), out_.block_gain.end(), out_.gain);
        std::fill(out_.block_motion_rad.begin(), out_.block_motion_rad.end(), out_.motion_rad);
      } else {
        advance_blocks();
      }
    }
  }

  void refit_gain() {
    sum(config_.row_step);
    const double to_burst = static_cast<double>(out_.gain), pg = 1 / square(config_.gain_prior);
    for (std::size_t k = 0; k < out_.block_gain.size(); ++k) {
      float& gain = out_.block_gain[k];
      const double* s = &out_.work.sums[k * kRefitSums];
      gain += static_cast<float>((pg * (to_burst - static_cast<double>(gain)) - s[3]) / (s[0] + pg));
    }
  }

 private:
  static double square(float x) { return static_cast<double>(x) * static_cast<double>(x); }

  void reset() {
    const auto blocks = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
    out_.motion_rad = 0, out_.gain = 1, out_.black_dn = burst_.noise.black_dn;
    out_.columns = columns_, out_.rows = rows_, out_.block_px = config_.block_px;
    out_.block_motion_rad.assign(blocks, 0.0F);
    out_.block_sigma_rad.assign(blocks, config_.motion_prior_rad);
    out_.block_gain.assign(blocks, 1.0F);
    out_.surface = {};
  }

  /// Each pass asks twice as many rows as the one before: the first finds the burst's motion, the last the blocks'.
  void sum(int row_step) {
    const PhaseMaps& maps = burst_.maps;
    BlockSums<kRefitSums> blocks(maps.phase_rad.width(), maps.phase_rad.height(), config_.block_px,
                                 out_.work.column_sums, out_.work.sums);
    CodeRows rows(out_, maps, &burst_.wraps);
    rows.expect(burst_.code, burst_.third_rad);
    for (int v = 0; v < maps.phase_rad.height(); v += row_step)
      add_refit_row(rows.at(v), burst_.noise, config_.max_residual, blocks.width(), blocks.columns_of(v));
    blocks.finish();
  }

  void advance_burst() {
    std::array<double, kRefitSums> all{};
    for (std::size_t k = 0; k < out_.work.sums.size(); ++k) all[k % kRefitSums] += out_.work.sums[k];
    const Step step = solve(all.data(), 1, 1);
    out_.gain += static_cast<float>(step.gain);
    out_.motion_rad = held(out_.motion_rad + static_cast<float>(step.motion));
  }

  /// Each block's step, held to the burst's new values by the priors.
  void advance_blocks() {
    const double pg = 1 / square(config_.gain_prior), pm = 1 / square(config_.motion_prior_rad);
    for (std::size_t k = 0; k < out_.block_gain.size(); ++k) {
      float &gain = out_.block_gain[k], &motion = out_.block_motion_rad[k];
      const double to_gain = static_cast<double>(out_.gain - gain),
                   to_motion = static_cast<double>(out_.motion_rad - motion);
      double* s = &out_.work.sums[k * kRefitSums];
      s[3] -= pg * to_gain, s[4] -= pm * to_motion;  // the prior pulls to the burst's values, not to the block's last
      const Step step = solve(s, pg, pm);
      out_.block_sigma_rad[k] = static_cast<float>(1 / std::sqrt(s[2] + pm));
      gain += static_cast<float>(step.gain);
      motion = held(motion + static_cast<float>(step.motion));
    }
  }

  [[nodiscard]] float held(float motion_rad) const {
    return std::clamp(motion_rad, -config_.largest_motion_rad, config_.largest_motion_rad);
  }

  MicroBurst burst_;
  const MicroRefitConfig& config_;
  MicroMotion& out_;
  int columns_ = 0, rows_ = 0;
};

MovedRow moved_row(PhaseMaps& m, int v) {
  const std::size_t at = m.phase_rad.index(0, v);
  return {&m.mean_dn[at], &m.cosine_dn[at], &m.sine_dn[at], &m.code_dn[at], &m.modulation_dn[at], &m.phase_rad[at]};
}

/// undo: undo_micro_motion as well, of each row before it is joined.
void join(const CodeJoin& in, const MicroRefitConfig& config, bool undo, PhaseMaps& maps, const CodeJoinChecks& checks,
          std::vector<float>& scratch) {
  const auto width = static_cast<std::size_t>(in.wraps.width());
  scratch.resize(4 * width);
  float *missed = scratch.data(), *noise_share = missed + width;
  const OrderDoubt doubt{noise_share + width, noise_share + 2 * width};
  const JoinLimits limits{
      {in.code.cosine[1], in.code.sine[1]}, config.outlier_sigmas, config.torn_sigmas, config.largest_gain};
  CodeRows rows(in.motion, maps, &in.wraps);
  rows.expect(in.code, in.third_rad);
  checks.strips.find_ends(in.spans, in.wraps.height());
  if (checks.misfit != nullptr) checks.misfit->start(in.wraps.width(), in.wraps.height());
  for (int v = 0; v < in.wraps.height(); ++v) {
    const CodeRow row = rows.at(v);
    if (undo) undo_motion_row(row, width, moved_row(maps, v));
    join_code_row(row, in.noise, limits, width,
                  {&maps.phase_rad(0, v), &maps.sigma_rad(0, v), missed, noise_share, doubt, &maps.reject(0, v)});
    checks.strips.take_row(v, doubt);
    if (checks.misfit != nullptr) checks.misfit->take_row(v, {missed, noise_share});
  }
  if (checks.misfit != nullptr) checks.misfit->add_to(maps.sigma_rad, kPhaseOfCode);
  checks.strips.withdraw(config.strip_evidence, maps.reject);
}

}  // namespace

void fit_micro_motion(const MicroBurst& burst, const MicroRefitConfig& config, MicroMotion& out) {
  Fitter(burst, config, out).run();
}

void refit_micro_gain(const MicroBurst& burst, const MicroRefitConfig& config, MicroMotion& motion) {
  Fitter(burst, config, motion).refit_gain();
}

void undo_micro_motion(const Map<std::int16_t>& wraps, const MicroMotion& motion, PhaseMaps& maps) {
  CodeRows rows(motion, maps, &wraps);
  for (int v = 0; v < wraps.height(); ++v)
    undo_motion_row(rows.at(v), static_cast<std::size_t>(wraps.width()), moved_row(maps, v));
}

void move_to_code_frame(const MicroMotion& motion, const PhaseMaps& maps, PhaseMaps& out) {
  const int w = maps.phase_rad.width(), h = maps.phase_rad.height();
  out.resize(w, h);
  out.sigma_rad = maps.sigma_rad;
  out.reject = maps.reject;
  CodeRows rows(motion, maps, nullptr);
  for (int v = 0; v < h; ++v) move_to_code_row(rows.at(v), static_cast<std::size_t>(w), moved_row(out, v));
}

void join_code_frame(const CodeJoin& in, const MicroRefitConfig& config, PhaseMaps& maps,
                     const CodeJoinChecks& checks) {
  std::vector<float> scratch;
  join(in, config, false, maps, checks, scratch);
}

void undo_motion_and_join(const CodeJoin& in, const MicroRefitConfig& config, PhaseMaps& maps,
                          const CodeJoinChecks& checks, std::vector<float>& scratch) {
  join(in, config, true, maps, checks, scratch);
}

}  // namespace enamel::pipeline
