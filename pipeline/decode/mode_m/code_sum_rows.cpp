#include "pipeline/decode/mode_m/code_sum_rows.hpp"

#include <algorithm>
#include <array>
#include <iterator>

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

void sums_loop(const PhaseMaps& phase, const NoiseModel& noise, float inverse_ratio, std::size_t at, CodeSumRow& out) {
  const float* __restrict phi = &phase.phase_rad[at], * __restrict cosine = &phase.cosine_dn[at];
  const float* __restrict sine = &phase.sine_dn[at], * __restrict d = &phase.code_dn[at];
  const float* __restrict mean = &phase.mean_dn[at];
  const Sums<float> o(out);
  const NoiseModel model = noise;
  const std::size_t width = out.xx.size();
  const float step = 1 + inverse_ratio;
  // var(D - Re(w z)): the code frame's own, A's third of it and at most phi's 2/3 (times the code's slope).
  const float noise_of_code = 1 + 1.0F / 3 + 2.0F / 3 * step * step;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const float t = phi[u] * inverse_ratio, ct = cos_poly(t), st = sin_poly(t);
    const float x = cosine[u] * ct - sine[u] * st, y = -(cosine[u] * st + sine[u] * ct);
    const bool known = d[u] == d[u];
    const float weight = select(known, 1, 0) / (noise_of_code * model.variance(mean[u]));
    const float seen = select(known, d[u], 0);
    o.put(u,
          {weight * x * x, weight * x * y, weight * y * y, weight * x * seen, weight * y * seen, weight * seen * seen});
  }
}

void unwrap_loop(const std::int16_t* wrap_counts, const std::int32_t* components, const TurnTable& table,
                 CodeSumRow& sums) {
  const std::int16_t* __restrict wraps = wrap_counts;
  const std::int32_t* __restrict component = components;
  const std::int32_t last = table.last;
  const float *cosine = table.cosine.data() + last, *sine = table.sine.data() + last;
  const Sums<float> o(sums);
  const std::size_t width = sums.xx.size();
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const std::int32_t k = component[u] < 0 ? 0 : wraps[u];
    const std::int32_t order = k < -last ? -last : (k > last ? last : k);
    o.put(u, turned(o.at(u), cosine[order], sine[order]));
  }
}

void windows_loop(const CodeSumRow& sums, const std::int32_t* components, float cost, CodeSumRow& windows,
                  std::uint8_t* flags) {
  const Sums<const float> in(sums);
  const Sums<float> out(windows);
  const std::size_t width = sums.xx.size();
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width - kStepWindow_px + 1; ++u)
    out.put(u, in.at(u) + in.at(u + 1) + in.at(u + 2) + in.at(u + 3));
  const std::int32_t* __restrict component = components;
  std::uint8_t* __restrict asked = flags;
  std::array<std::int32_t, kPolarStretch> wide;  // a loop that mixes widths would not fit the registers
  for (std::size_t from = 0; from < width; from += kPolarStretch) {
    const std::size_t begin = std::max(from, kStepReach_px);
    const std::size_t end = std::min(from + kPolarStretch, width - kStepReach_px + 1);
    wide.fill(0);
    ENAMEL_INDEPENDENT
    for (std::size_t u = begin; u < end; ++u) {
      const CodeSums left = out.at(u - kStepReach_px), right = out.at(u + kStepGap_px);
      const float gain = 0.5F * (explained(left) + explained(right) - explained(left + right));
      const std::int32_t first = component[u - kStepReach_px], last = component[u + kStepReach_px - 1];
      wide[u - from] =
          static_cast<std::int32_t>((first >= 0) & (first == last)) & static_cast<std::int32_t>(!(gain < cost));
    }
    const std::size_t count = std::min(kPolarStretch, width - from);
    for (std::size_t j = 0; j < count; ++j) asked[from + j] = static_cast<std::uint8_t>(wide[j]);
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

static_assert(kStepWindow_px == 4);

HWY_EXPORT(sums_loop);
HWY_EXPORT(unwrap_loop);
HWY_EXPORT(windows_loop);

void code_sums_of_row(const PhaseMaps& phase, const NoiseModel& noise, const MicroCode& code, std::size_t row,
                      CodeSumRow& out) {
  const auto width = static_cast<std::size_t>(phase.phase_rad.width());
  out.resize(width);
  HWY_DYNAMIC_DISPATCH(sums_loop)(phase, noise, code.inverse_ratio, row * width, out);
}

TurnTable::TurnTable(const MicroCode& code) : last(static_cast<std::int32_t>(code.cosine.size()) - 1) {
  cosine.assign(code.cosine.rbegin(), code.cosine.rend());
  cosine.insert(cosine.end(), code.cosine.begin() + 1, code.cosine.end());
  std::transform(code.sine.rbegin(), code.sine.rend(), std::back_inserter(sine), [](float s) { return -s; });
  sine.back() = 0;
  sine.insert(sine.end(), code.sine.begin() + 1, code.sine.end());
}

void unwrap_sums_row(const std::int16_t* wraps, const std::int32_t* component, const TurnTable& table,
                     CodeSumRow& sums) {
  HWY_DYNAMIC_DISPATCH(unwrap_loop)(wraps, component, table, sums);
}

void step_windows_row(const CodeSumRow& sums, const std::int32_t* component, float cost, CodeSumRow& windows,
                      std::uint8_t* asked) {
  windows.resize(sums.xx.size());
  HWY_DYNAMIC_DISPATCH(windows_loop)(sums, component, cost, windows, asked);
}

}  // namespace enamel::pipeline
#endif
