// Rows of micro_refit.hpp, compiled per instruction set. Private to pipeline/decode.
#pragma once

#include <cstddef>

#include "pipeline/decode/mode_m/code_strips.hpp"
#include "pipeline/decode/mode_m/micro_phase.hpp"
#include "pipeline/decode/mode_m/micro_refit.hpp"
#include "pipeline/decode/phase/block_fit.hpp"
#include "pipeline/decode/phase/frame_turns.hpp"

namespace enamel::pipeline {

/// In place of a wrap count, as place_spans marks them.
inline constexpr float kUnplaced = kUnplacedWraps, kNoSurface = kNoWraps;

/// Pixels side by side, as compute_micro_phase measured them.
struct CodePixels {
  const float *mean = nullptr, *cosine = nullptr, *sine = nullptr, *code = nullptr, *modulation = nullptr,
              *phase = nullptr;
};

/// All of the row that begins at `at`.
[[nodiscard]] inline CodePixels code_pixels(const PhaseMaps& m, std::size_t at) {
  return {&m.mean_dn[at], &m.cosine_dn[at], &m.sine_dn[at], &m.code_dn[at], &m.modulation_dn[at], &m.phase_rad[at]};
}

/// What a row of pixels is seen under.
struct CodeRow {
  CodePixels pixels;
  const float* wraps = nullptr;  ///< Phi = phase + 2 pi wraps; kUnplaced where the order is unknown, else kNoSurface
  const float* motion_rad = nullptr;
  const float* gain = nullptr;
  const float* light = nullptr;              ///< dA/A per frame interval
  const float* motion_change_rad = nullptr;  ///< of eps per frame interval
  const float* light_change = nullptr;       ///< d2A/A
  float inverse_ratio = 0;                   ///< 1/L
  float harmonic = 0;                        ///< B2/B
  float black_dn = 0;
  bool steady = false;  ///< light and both changes are 0
};

inline constexpr std::size_t kRefitSums = 5;  ///< layout: gg, gm, mm, gR, mR with the slopes g = dR/dgain, m = dR/deps

/// Adds the row's normal equations to sums[k * width + u], weighted by 1/variance of R.
void add_refit_row(const CodeRow& row, const NoiseModel& noise, float max_residual, std::size_t width, float* sums);

/// R of a row's pixels, and by how much it falls per unit of motion, of light and of gain. R is NaN without code and
/// without an order.
struct ResidualRow {
  float *residual, *by_motion, *by_light, *by_gain;
};
void code_residual_row(const CodeRow& row, std::size_t count, const ResidualRow& out);

/// layout: unknowns of the odd frame: phase of the code frame alone, skew of the other three, both again of light; then
/// beside them motion, light, gain and two harmonics as far as they differ from what `row` says.
inline constexpr std::size_t kOddColumns = 9;
inline constexpr int kOddUnknowns = 4;
inline constexpr std::size_t kMicroOddSums = BlockFit<kOddColumns>::kSums + 1;

/// Adds the row's normal equations to sums[k * width + u], weighted by 1/variance of R: those of BlockFit, last the
/// pixels with a code.
void add_micro_odd_row(const CodeRow& row, const NoiseModel& noise, float max_residual, std::size_t width, float* sums);

/// Phase and A - black of every second pixel, count of them, as they were at mid-burst. Of the row, gain, modulation,
/// code and orders are not read.
void sparse_mid_burst_row(const CodeRow& row, std::size_t count, float* phase_rad, float* light_dn);

/// A row's pixels as they were at mid-burst. May be the row's own.
struct MovedRow {
  float *mean, *cosine, *sine, *code, *modulation, *phase;
};
/// Stretches of no surface are left as they are.
void undo_motion_row(const CodeRow& row, std::size_t width, const MovedRow& out);

/// Of all pixels that are of a surface, the others as they are; but phase, cosine and sine as they were when the code
/// frame was taken, kCodeTime after mid-burst.
void move_to_code_row(const CodeRow& row, std::size_t width, const MovedRow& out);

struct JoinedRow {
  float *phase, *sigma;  ///< may be the row's own
  float* missed;  ///< by how many sigmas the code is off its prediction, squared; 0 without order, NaN without code
  /// Variance of what it is off by, by noise, over B squared (misfit.hpp); 0 without order and of rejected pixels.
  float* noise;
  OrderDoubt doubt;
  PixelReject* reject;  ///< kNone becomes kEdge where the code is torn_sigmas off
};
struct JoinLimits {
  Turn order_step;                                  ///< angle by which the next order turns the code
  float outlier_sigmas, torn_sigmas, largest_gain;  ///< MicroRefitConfig's
};
void join_code_row(const CodeRow& row, const NoiseModel& noise, const JoinLimits& limits, std::size_t width,
                   const JoinedRow& out);

}  // namespace enamel::pipeline
