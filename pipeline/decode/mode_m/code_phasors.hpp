// What the code frame of mode M says over some pixels: z = p + i q of micro_evidence.hpp, and how well it is known.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/decode/mode_m/chosen.hpp"
#include "pipeline/decode/mode_m/micro_code.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/decode/unwrap/code_evidence.hpp"

namespace enamel::pipeline {

/// Normal equations of z = p + i q over some pixels, each weighted by 1/variance of D: [xx xy; xy yy] (p, q) = (xd, yd)
/// with x = Re w, y = -Im w. Add those of several pixels for their union.
struct CodeSums {
  float xx = 0, xy = 0, yy = 0, xd = 0, yd = 0, dd = 0;
};

[[nodiscard]] inline CodeSums operator+(const CodeSums& a, const CodeSums& b) noexcept {
  return {a.xx + b.xx, a.xy + b.xy, a.yy + b.yy, a.xd + b.xd, a.yd + b.yd, a.dd + b.dd};
}

/// Of the pixels of a row, or of all segments: one array a sum.
struct CodeSumRow {
  std::vector<float> xx, xy, yy, xd, yd, dd;

  void resize(std::size_t count);
  [[nodiscard]] CodeSums at(std::size_t k) const { return {xx[k], xy[k], yy[k], xd[k], yd[k], dd[k]}; }
  void put(std::size_t k, const CodeSums& s) {
    xx[k] = s.xx, xy[k] = s.xy, yy[k] = s.yy, xd[k] = s.xd, yd[k] = s.yd, dd[k] = s.dd;
  }
};

/// z, and the inverse of its covariance: of noise, and of what blur, motion and harmonics do to z, about independent of
/// the order.
struct CodePhasor {
  float p = 0, q = 0;
  float wpp = 0, wpq = 0, wqq = 0;
  float most = 0;  ///< cost of a segment whose code lies
  /// 1/variance that noise alone gives z, in its worst direction; 0 where that is more than blur and motion give it.
  float sharp = 0;
};

/// Of all segments, one array a number.
struct CodePhasors {
  std::vector<float> p, q, wpp, wpq, wqq, most, sharp;

  void resize(std::size_t count);
  [[nodiscard]] CodePhasor at(std::size_t k) const { return {p[k], q[k], wpp[k], wpq[k], wqq[k], most[k], sharp[k]}; }
};

/// One of each of the sums; no code, no phasor: all zeros. outlier_cost: of a segment whose code may be anything.
void find_phasors(const CodeSumRow& sums, float outlier_cost, CodePhasors& out);

/// kCodeGain times cosine and sine of each order's turn, and kOrderStates entries on either side for orders beyond the
/// frame, whose costs nobody asks for.
struct TurnTable {
  std::vector<float> cosine, sine;

  void make(const MicroCode& code);
};

/// Costs of each phasor from `first` on at kOrderStates orders, of which the first of each is given.
void cost_of_orders(const CodePhasors& said, const TurnTable& table, std::size_t first,
                    std::span<const std::int32_t> first_orders, StateNats* out);

/// Negative log probability of the phasor if its pixels had an order with this cosine and sine of the code's turn.
[[nodiscard, gnu::always_inline]] inline float cost_of_turn(const CodePhasor& z, float cosine, float sine) noexcept {
  const float p = z.p - kCodeGain * cosine, q = z.q - kCodeGain * sine;
  return smaller(0.5F * (p * p * z.wpp + 2 * p * q * z.wpq + q * q * z.wqq), z.most);
}

}  // namespace enamel::pipeline
