#include "pipeline/decode/mode_m/code_sum_rows.hpp"

#include <algorithm>
#include <array>

#include "pipeline/decode/mode_m/micro_pixel.hpp"
#include "pipeline/decode/phase/frame_turns.hpp"
#include "pipeline/decode/phase/polar_rows.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/mode_m/code_sum_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

/// A row's sums, in each loop's own copy, which cannot alias what it writes.
template <class Float>
struct Sums {
  Float *xx, *xy, *yy, *xd, *yd, *dd;

  template <class Row>
  explicit Sums(Row& r)
      : xx(r.xx.data()), xy(r.xy.data()), yy(r.yy.data()), xd(r.xd.data()), yd(r.yd.data()), dd(r.dd.data()) {}

  [[nodiscard, gnu::always_inline]] CodeSums at(std::size_t u) const {
    return {xx[u], xy[u], yy[u], xd[u], yd[u], dd[u]};
  }
  [[gnu::always_inline]] void put(std::size_t u, const CodeSums& s) const {
    xx[u] = s.xx, xy[u] = s.xy, yy[u] = s.yy, xd[u] = s.xd, yd[u] = s.yd, dd[u] = s.dd;
  }
};

/// wrap_counts: of the flood, if kUnwrapped.
template <bool kUnwrapped>
void add_sums(const PhaseMaps& phase, const NoiseModel& noise, float inverse_ratio, const std::int16_t* wrap_counts,
              std::size_t at, CodeSumRow& out) {
  const float* __restrict phi = &phase.phase_rad[at], * __restrict cosine = &phase.cosine_dn[at];
  const float* __restrict sine = &phase.sine_dn[at], * __restrict d = &phase.code_dn[at];
  const float* __restrict mean = &phase.mean_dn[at];
  const std::int16_t* __restrict wraps = wrap_counts;
  const Sums<float> o(out);
  const NoiseModel model = noise;
  const std::size_t width = out.xx.size();
  const float step = 1 + inverse_ratio;
  // var(D - Re(w z)): the code frame's own, A's third of it and at most phi's 2/3 (times the code's slope).
  const float noise_of_code = 1 + 1.0F / 3 + 2.0F / 3 * step * step;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const float t = phi[u] * inverse_ratio;
    Turn turn{0, 0};
    if constexpr (kUnwrapped) {
      turn = turn_of(wrap_once(t + kTwoPiF * fraction(static_cast<float>(wraps[u]) * inverse_ratio)));
    } else {
      turn = {cos_poly(t), sin_poly(t)};
    }
    const float x = cosine[u] * turn.cos - sine[u] * turn.sin, y = -(cosine[u] * turn.sin + sine[u] * turn.cos);
    const bool known = d[u] == d[u];
    const float weight = select(known, 1, 0) / (noise_of_code * model.variance(mean[u]));
    const float seen = select(known, d[u], 0);
    o.put(u,
          {weight * x * x, weight * x * y, weight * y * y, weight * x * seen, weight * y * seen, weight * seen * seen});
  }
}

void sums_loop(const PhaseMaps& phase, const NoiseModel& noise, float inverse_ratio, const std::int16_t* wraps,
               std::size_t at, CodeSumRow& out) {
  (wraps == nullptr ? add_sums<false> : add_sums<true>)(phase, noise, inverse_ratio, wraps, at, out);
}

void windows_loop(const CodeSumRow& sums, const std::int32_t* components, float cost, StepWindows& windows,
                  std::uint8_t* flags) {
  const Sums<const float> in(sums);
  const Sums<float> out(windows.sums);
  float* __restrict by_one = windows.explained.data();
  const std::size_t width = sums.xx.size();
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width - kStepWindow_px + 1; ++u) {
    const CodeSums sum = in.at(u) + in.at(u + 1) + in.at(u + 2) + in.at(u + 3);
    out.put(u, sum);
    by_one[u] = explained(sum);
  }
  const std::int32_t* __restrict component = components;
  std::uint8_t* __restrict asked = flags;
  std::array<std::int32_t, kPolarStretch> wide;  // a loop that mixes widths would not fit the registers
  for (std::size_t from = 0; from < width; from += kPolarStretch) {
    const std::size_t begin = std::max(from, kStepReach_px);
    const std::size_t end = std::min(from + kPolarStretch, width - kStepReach_px + 1);
    wide.fill(0);
    ENAMEL_INDEPENDENT
    for (std::size_t u = begin; u < end; ++u) {
      const CodeSums both = out.at(u - kStepReach_px) + out.at(u + kStepGap_px);
      const float gain = 0.5F * (by_one[u - kStepReach_px] + by_one[u + kStepGap_px] - explained(both));
      const std::int32_t first = component[u - kStepReach_px], last = component[u + kStepReach_px - 1];
      wide[u - from] =
          static_cast<std::int32_t>((first >= 0) & (first == last)) & static_cast<std::int32_t>(!(gain < cost));
    }
    const std::size_t count = std::min(kPolarStretch, width - from);
    for (std::size_t j = 0; j < count; ++j) asked[from + j] = static_cast<std::uint8_t>(wide[j]);
  }
}

void misfits_loop(const MicroCode& code, float cost, StepCandidates& candidates) {
  const Sums<const float> l(candidates.left), r(candidates.right);
  float* __restrict misfit = candidates.misfit.data();
  std::array<Turn, kMostJump> jump;
  for (std::size_t d = 0; d < kMostJump; ++d) jump[d] = {code.cosine[d + 1], code.sine[d + 1]};
  const std::size_t count = candidates.misfit.size();
  ENAMEL_INDEPENDENT
  for (std::size_t k = 0; k < count; ++k) {
    const CodeSums left = l.at(k), right = r.at(k);
    float best = 0;
    for (std::size_t d = 0; d < kMostJump; ++d) {
      best = larger(best, explained(left + turned(right, jump[d].cos, -jump[d].sin)));
      best = larger(best, explained(left + turned(right, jump[d].cos, jump[d].sin)));
    }
    const bool jumps = 0.5F * (best - explained(left + right)) > cost;
    misfit[k] = select(jumps, 0.5F * (left.dd + right.dd - best), kNoJump);
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

static_assert(kStepWindow_px == 4);

HWY_EXPORT(sums_loop);
HWY_EXPORT(windows_loop);
HWY_EXPORT(misfits_loop);

void code_sums_of_row(const PhaseMaps& phase, const NoiseModel& noise, const MicroCode& code, std::size_t row,
                      CodeSumRow& out) {
  unwrapped_sums_of_row(phase, noise, code, nullptr, row, out);
}

void unwrapped_sums_of_row(const PhaseMaps& phase, const NoiseModel& noise, const MicroCode& code,
                           const std::int16_t* wraps, std::size_t row, CodeSumRow& out) {
  const auto width = static_cast<std::size_t>(phase.phase_rad.width());
  out.resize(width);
  HWY_DYNAMIC_DISPATCH(sums_loop)(phase, noise, code.inverse_ratio, wraps, row * width, out);
}

void StepCandidates::resize(std::size_t count) { left.resize(count), right.resize(count), misfit.resize(count); }

void find_misfits(const MicroCode& code, float cost, StepCandidates& candidates) {
  HWY_DYNAMIC_DISPATCH(misfits_loop)(code, cost, candidates);
}

void step_windows_row(const CodeSumRow& sums, const std::int32_t* component, float cost, StepWindows& windows,
                      std::uint8_t* asked) {
  windows.sums.resize(sums.xx.size());
  windows.explained.resize(sums.xx.size());
  HWY_DYNAMIC_DISPATCH(windows_loop)(sums, component, cost, windows, asked);
}

}  // namespace enamel::pipeline
#endif
