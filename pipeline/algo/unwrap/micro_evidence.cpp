#include "pipeline/algo/unwrap/micro_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/algo/phase/cell_span.hpp"
#include "pipeline/algo/phase/poly_trig.hpp"
#include "pipeline/algo/unwrap/code_sum_rows.hpp"

namespace enamel::algo {
namespace {

/// Of the code frame's modulation to B: from 1 without blur down to 0.72 where a Gaussian blur leaves 0.4 of B (its
/// share at frequency f (1 + 1/6) is that at f to the power 1.36).
constexpr float kGain = 0.9F;
/// Spread of z about kGain exp(2 pi i k/L), each way: that blur, and motion of 0.2 rad a frame, which turns it by 0.16.
constexpr float kSpread = 0.15F;
constexpr double kRidge = 1e-2;                 ///< z is unknown to within 10 before the piece is seen
constexpr double kOutlierArea_per_tau = 1.125;  ///< a lying z is anywhere within 1.5 of 0: pi 1.5^2/(2 pi)
constexpr float kShortest = 0.4F, kLongest = 1.6F;
constexpr float kStepShare = 1.0F / 3;
constexpr std::int32_t kEndTrim_px = 2;  ///< a few pixels already tell: one that blur mixes, one to spare

}  // namespace

CodePhasor phasor_of(const CodeSums& sums, float outlier_cost) {
  const double a = static_cast<double>(sums.xx) + kRidge, b = static_cast<double>(sums.xy),
               d = static_cast<double>(sums.yy) + kRidge;
  const double det = a * d - b * b;
  CodePhasor out;
  if (!(det > 1e-9 * a * d)) return out;
  const double h1 = static_cast<double>(sums.xd), h2 = static_cast<double>(sums.yd);
  out.p = static_cast<float>((d * h1 - b * h2) / det);
  out.q = static_cast<float>((a * h2 - b * h1) / det);
  // Covariance of noise, and of the spread on top; then its inverse.
  constexpr double kSpread2 = static_cast<double>(kSpread) * static_cast<double>(kSpread);
  const double cpp = d / det + kSpread2, cpq = -b / det, cqq = a / det + kSpread2;
  const double cdet = cpp * cqq - cpq * cpq;
  out.wpp = static_cast<float>(cqq / cdet);
  out.wpq = static_cast<float>(-cpq / cdet);
  out.wqq = static_cast<float>(cpp / cdet);
  const double cap = static_cast<double>(outlier_cost) + std::log(kOutlierArea_per_tau / std::sqrt(cdet));
  out.most = static_cast<float>(std::max(cap, 0.0));
  const double half = 0.5 * (a + d), least = half - std::sqrt(std::max(half * half - det, 0.0));
  out.sharp = least * kSpread2 > 1;
  return out;
}

float cost_of_order(const CodePhasor& z, const MicroCode& code, std::size_t order) {
  const float p = z.p - kGain * code.cosine[order], q = z.q - kGain * code.sine[order];
  return smaller(0.5F * (p * p * z.wpp + 2 * p * q * z.wpq + q * q * z.wqq), z.most);
}

void MicroEvidence::measure(const PhaseMaps& phase, const NoiseModel& noise, const std::vector<Piece>& pieces,
                            const MicroCode& code, float outlier_cost) {
  code_ = &code;
  mean_turn_rad_ = 0;
  said_.assign(pieces.size(), {});
  std::int32_t row = -1;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    if (pieces[k].row != row) {
      row = pieces[k].row;
      code_sums_of_row(phase, noise, code, static_cast<std::size_t>(row), row_);
    }
    const PieceCore core = core_of(pieces, k, kEndTrim_px, phase.phase_rad.width());
    CodeSums s;
    for (std::int32_t u = core.begin; u < core.end; ++u) s = s + row_.at(static_cast<std::size_t>(u));
    said_[k] = phasor_of(s, outlier_cost);
  }
}

void MicroEvidence::costs(std::size_t piece, std::int32_t first_cell, std::span<float> out) const {
  const CodePhasor& z = said_[piece];
  const auto first = static_cast<std::size_t>(turn_of_cell(first_cell));
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = cost_of_order(z, *code_, first + k);
}

MicroEvidence::Turned MicroEvidence::turned(std::size_t piece, std::int32_t cell) const {
  const CodePhasor& z = said_[piece];
  const auto order = static_cast<std::size_t>(turn_of_cell(cell));
  const float c = code_->cosine[order], s = code_->sine[order];
  return {z.p * c + z.q * s, z.q * c - z.p * s};
}

float MicroEvidence::settle(const std::vector<Piece>& pieces, const OrderResult& orders) {
  double along = 0, across = 0;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    if (!orders.pieces[k].decided || !said_[k].sharp) continue;
    const Turned z = turned(k, pieces[k].cell + 2 * orders.pieces[k].shift);
    const auto pixels = static_cast<float>(pieces[k].end - pieces[k].begin);
    along += static_cast<double>(z.along * pixels);
    across += static_cast<double>(z.across * pixels);
  }
  mean_turn_rad_ = atan2_poly(static_cast<float>(across), static_cast<float>(along));
  return mean_turn_rad_;
}

Stance MicroEvidence::stance(std::size_t piece, std::int32_t cell) const {
  if (!said_[piece].sharp) return Stance::kSilent;
  const Turned z = turned(piece, cell);
  const float length = root(z.along * z.along + z.across * z.across);
  const float off = wrap_once(atan2_poly(z.across, z.along) - mean_turn_rad_);
  const bool near = std::abs(off) < kStepShare * kTwoPiF * code_->inverse_ratio;
  return near && length > kShortest && length < kLongest ? Stance::kAgrees : Stance::kContradicts;
}

}  // namespace enamel::algo
