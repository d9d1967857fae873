#include "pipeline/decode/mode_m/code_phasors.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/mode_m/code_phasors.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

/// derived: a lying z is anywhere within 1.5 of 0: ln(pi 1.5^2/(2 pi)).
constexpr float kLogOutlierArea = 0.11778F;

void phasor_loop(const CodeSumRow& sums, float outlier_cost, CodePhasors& phasors) {
  const float* __restrict xx = sums.xx.data(), * __restrict xy = sums.xy.data(), * __restrict yy = sums.yy.data();
  const float* __restrict xd = sums.xd.data(), * __restrict yd = sums.yd.data();
  float* __restrict p = phasors.p.data(), * __restrict q = phasors.q.data(), * __restrict wpp = phasors.wpp.data();
  float* __restrict wpq = phasors.wpq.data(), * __restrict wqq = phasors.wqq.data();
  float* __restrict most = phasors.most.data(), * __restrict sharp = phasors.sharp.data();
  constexpr double kSpread2 = kCodeSpread * kCodeSpread;
  const float unseen = outlier_cost + kLogOutlierArea;
  const std::size_t count = sums.xx.size();
  ENAMEL_INDEPENDENT
  for (std::size_t k = 0; k < count; ++k) {
    const double a = static_cast<double>(xx[k]) + kCodeRidge, b = static_cast<double>(xy[k]),
                 d = static_cast<double>(yy[k]) + kCodeRidge;
    const double h1 = static_cast<double>(xd[k]), h2 = static_cast<double>(yd[k]);
    const double det = a * d - b * b, least_det = 1e-9 * a * d;
    const float known = det > least_det ? 1.0F : 0.0F;
    const double per_det = 1 / (det > least_det ? det : least_det);
    // Covariance of noise, and of the spread on top; then its inverse.
    const double cpp = d * per_det + kSpread2, cpq = -b * per_det, cqq = a * per_det + kSpread2;
    const double cdet = cpp * cqq - cpq * cpq, per_cdet = 1 / cdet;
    // The lesser eigenvalue of the normal equations.
    const double half = 0.5 * (a + d), rest = half * half - det, least = half - std::sqrt(rest > 0 ? rest : 0.0);
    p[k] = known * static_cast<float>((d * h1 - b * h2) * per_det);
    q[k] = known * static_cast<float>((a * h2 - b * h1) * per_det);
    wpp[k] = known * static_cast<float>(cqq * per_cdet);
    wpq[k] = known * static_cast<float>(-cpq * per_cdet);
    wqq[k] = known * static_cast<float>(cpp * per_cdet);
    most[k] = known * larger(unseen - 0.5F * log_poly(static_cast<float>(cdet)), 0);
    sharp[k] = least * kSpread2 > 1 ? known * static_cast<float>(least) : 0.0F;
  }
}

void orders_loop(const CodePhasors& said, const TurnTable& table, std::size_t first,
                 std::span<const std::int32_t> first_orders, StateNats* out) {
  const auto last = static_cast<std::int32_t>(table.cosine.size() - kOrderStates);
  for (std::size_t k = 0; k < first_orders.size(); ++k) {
    const CodePhasor z = said.at(first + k);
    const auto at = static_cast<std::size_t>(std::clamp(first_orders[k] + kStates, 0, last));
    const float* __restrict cosine = &table.cosine[at], * __restrict sine = &table.sine[at];
    float* __restrict cost = out[k].data();
    for (std::size_t j = 0; j < kOrderStates; ++j) {
      const float p = z.p - cosine[j], q = z.q - sine[j];
      cost[j] = smaller(0.5F * (p * p * z.wpp + 2 * p * q * z.wpq + q * q * z.wqq), z.most);
    }
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(phasor_loop);
HWY_EXPORT(orders_loop);

void TurnTable::make(const MicroCode& code) {
  const std::size_t orders = code.cosine.size();
  cosine.assign(orders + 2 * kOrderStates, 0.0F), sine.assign(orders + 2 * kOrderStates, 0.0F);
  for (std::size_t k = 0; k < orders; ++k) {
    cosine[k + kOrderStates] = kCodeGain * code.cosine[k];
    sine[k + kOrderStates] = kCodeGain * code.sine[k];
  }
}

void cost_of_orders(const CodePhasors& said, const TurnTable& table, std::size_t first,
                    std::span<const std::int32_t> first_orders, StateNats* out) {
  HWY_DYNAMIC_DISPATCH(orders_loop)(said, table, first, first_orders, out);
}

void CodeSumRow::resize(std::size_t count) {
  for (auto* v : {&xx, &xy, &yy, &xd, &yd, &dd}) v->resize(count);
}

void CodePhasors::resize(std::size_t count) {
  for (auto* v : {&p, &q, &wpp, &wpq, &wqq, &most, &sharp}) v->resize(count);
}

void find_phasors(const CodeSumRow& sums, float outlier_cost, CodePhasors& out) {
  out.resize(sums.xx.size());
  HWY_DYNAMIC_DISPATCH(phasor_loop)(sums, outlier_cost, out);
}

}  // namespace enamel::pipeline
#endif
