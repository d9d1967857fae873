#include "pipeline/decode/mode_m/micro_evidence.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "pipeline/decode/mode_m/chosen.hpp"
#include "pipeline/decode/phase/cell_span.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"

namespace enamel::pipeline {
namespace {

/// Of pixels [begin, end), but for dd, which nobody asks for. Every second one by itself: a sum waits for the one
/// before.
CodeSums sum_over(const CodeSumRow& row, std::int32_t begin, std::int32_t end) {
  const float *xx = row.xx.data(), *xy = row.xy.data(), *yy = row.yy.data(), *xd = row.xd.data(), *yd = row.yd.data();
  CodeSums even, odd;
  const auto add = [&](CodeSums& to, std::int32_t u) {
    to.xx += xx[u], to.xy += xy[u], to.yy += yy[u], to.xd += xd[u], to.yd += yd[u];
  };
  std::int32_t u = begin;
  for (; u + 1 < end; u += 2) add(even, u), add(odd, u + 1);
  if (u < end) add(even, u);
  return even + odd;
}

}  // namespace

void MicroEvidence::measure(const PhaseMaps& phase, const NoiseModel& noise, const std::vector<Segment>& segments,
                            const MicroCode& code, float outlier_cost) {
  code_ = &code;
  mean_ = {1, 0};
  segments_.resize(segments.size());
  std::int32_t row = -1;
  for (std::size_t k = 0; k < segments.size(); ++k) {
    if (segments[k].row != row) {
      row = segments[k].row;
      code_sums_of_row(phase, noise, code, static_cast<std::size_t>(row), row_);
    }
    const SegmentCore core = core_of(segments, k, kMicroEndTrim_px, phase.phase_rad.width());
    segments_.put(k, sum_over(row_, core.begin, core.end));
  }
  find_phasors(segments_, outlier_cost, said_);
  turns_.make(code);
  least_sharp_ = least_sharp();
}

float MicroEvidence::least_sharp() const {
  const float third = kCodeGain * sin_poly(kStepShare * kTwoPiF * code_->inverse_ratio);
  const float keen = kStanceSigmas * kStanceSigmas / (third * third);
  std::size_t sharp = 0, keener = 0;
  for (const float each : said_.sharp) {
    sharp += each > 0 ? 1U : 0U;
    keener += each > keen ? 1U : 0U;
  }
  return static_cast<double>(keener) >= kKeenShare * static_cast<double>(sharp) ? keen : 0;
}

void MicroEvidence::costs(std::size_t segment, std::int32_t first_cell, std::span<float> out) const {
  const CodePhasor z = said_.at(segment);
  const auto first = static_cast<std::size_t>(wraps_of_cell(first_cell));
  const float* __restrict cosine = code_->cosine.data() + first, * __restrict sine = code_->sine.data() + first;
  float* __restrict cost = out.data();
  const std::size_t count = out.size();
  ENAMEL_INDEPENDENT
  for (std::size_t k = 0; k < count; ++k) cost[k] = cost_of_turn(z, cosine[k], sine[k]);
}

void MicroEvidence::costs_of_states(std::size_t first, std::span<const std::int32_t> first_cells,
                                    StateNats* out) const {
  constexpr std::size_t kMost = 64;  // layout: at a time
  std::array<std::int32_t, kMost> orders;
  for (std::size_t from = 0; from < first_cells.size(); from += kMost) {
    const auto cells = first_cells.subspan(from, std::min(kMost, first_cells.size() - from));
    std::ranges::transform(cells, orders.begin(), wraps_of_cell);
    cost_of_orders(said_, turns_, first + from, {orders.data(), cells.size()}, out + from);
  }
}

MicroEvidence::Turned MicroEvidence::turned(std::size_t segment, std::int32_t cell) const {
  const auto order = static_cast<std::size_t>(wraps_of_cell(cell));
  const float p = said_.p[segment], q = said_.q[segment], c = code_->cosine[order], s = code_->sine[order];
  return {p * c + q * s, q * c - p * s};
}

float MicroEvidence::settle(const std::vector<Segment>& segments, const OrderResult& orders) {
  double along = 0, across = 0;
  for (std::size_t k = 0; k < segments.size(); ++k) {
    if (!orders.segments[k].decided || !(said_.sharp[k] > least_sharp_)) continue;
    const Turned z = turned(k, segments[k].cell + 2 * orders.segments[k].shift);
    const auto pixels = static_cast<float>(segments[k].end - segments[k].begin);
    along += static_cast<double>(z.along * pixels);
    across += static_cast<double>(z.across * pixels);
  }
  const float turn_rad = atan2_poly(static_cast<float>(across), static_cast<float>(along));
  const double length = std::sqrt(along * along + across * across);
  if (length > 0) mean_ = {static_cast<float>(along / length), static_cast<float>(across / length)};
  return turn_rad;
}

Stance MicroEvidence::stance(std::size_t segment, std::int32_t cell) const {
  if (!(said_.sharp[segment] > least_sharp_)) return Stance::kSilent;
  const Turned z = turned(segment, cell);
  const float length2 = z.along * z.along + z.across * z.across;
  const float along = z.along * mean_.along + z.across * mean_.across;
  const float across = z.across * mean_.along - z.along * mean_.across;
  const float most_rad = kStepShare * kTwoPiF * code_->inverse_ratio;  // well below pi/2
  const bool near = std::abs(across) * cos_poly(most_rad) < along * sin_poly(most_rad);
  const bool long_enough = length2 > kShortestCode * kShortestCode && length2 < kLongestCode * kLongestCode;
  return near && long_enough ? Stance::kAgrees : Stance::kContradicts;
}

}  // namespace enamel::pipeline
