#include "pipeline/decode/mode_t/ripple_depth.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/decode/mode_t/chosen.hpp"
#include "pipeline/decode/mode_t/ripple_depth_rows.hpp"

namespace enamel::pipeline {
namespace {

/// Standard deviations of an amplitude's noise. derived: of the eight amplitudes noise alone takes one so far in one
/// burst of 2000.
constexpr double kClear = 4;

bool stands_clear(const PhaseRipple& ripple, double pixels) {
  for (std::size_t m = 0; m < kRippleTerms; ++m) {
    const double noise = std::sqrt(amplitude_variance(m + 1, pixels));
    if (std::max(std::abs(ripple.cosine[m]), std::abs(ripple.sine[m])) > kClear * noise) return true;
  }
  return false;
}

/// From the powers' sums of x over the counted pixels.
DepthPolynomials orthonormal(const std::array<double, 5>& sums) {
  DepthPolynomials p;
  const double n = sums[0], a = sums[1] / n;
  const double e2 = sums[2] / n, e3 = sums[3] / n, e4 = sums[4] / n;
  const double m2 = e2 - a * a, m3 = e3 - 3 * a * e2 + 2 * a * a * a;
  const double m4 = e4 - 4 * a * e3 + 6 * a * a * e2 - 3 * a * a * a * a;
  if (!(m2 > kLeastDepthSpread_rad * kLeastDepthSpread_rad)) return p;
  p.mean = a;
  p.reach = kDepthReach * std::sqrt(m2);
  p.per_d = 1 / std::sqrt(m2);
  p.tilt = m3 / m2, p.level = m2;
  const double rest = m4 - m3 * m3 / m2 - m2 * m2;
  if (rest > kLeastDepthRest * m4) p.scale = 1 / std::sqrt(rest);
  return p;
}

/// x in the middle of a span, which all its pixels are weighed by.
class SpanDepths {
 public:
  SpanDepths(std::span<const CellSpan> spans, const PhaseMaps& maps, const RayDepth& rays)
      : spans_(spans), maps_(maps), rays_(rays) {}

  [[nodiscard]] std::array<double, 5> power_sums() const {
    std::array<double, 5> sums{};
    each_asked_span(spans_, [&](const CellSpan& s) {
      double power = s.end - s.begin;
      for (double& sum : sums) sum += power, power *= depth_of(s);
    });
    return sums;
  }

  template <class Polynomial>
  [[nodiscard]] PhaseMoments moments(const DepthPolynomials& p, const Polynomial& value) const {
    return phase_moments(spans_, maps_, [&](const CellSpan& s) {
      return static_cast<float>(value(std::clamp(depth_of(s) - p.mean, -p.reach, p.reach)));
    });
  }

 private:
  [[nodiscard]] double depth_of(const CellSpan& s) const {
    const auto i = static_cast<std::size_t>(s.row) * static_cast<std::size_t>(maps_.phase_rad.width()) +
                   static_cast<std::size_t>((s.begin + s.end) / 2);
    return (s.cell + 0.5) * std::numbers::pi - static_cast<double>(rays_.phase_mid_rad[i]);
  }
  std::span<const CellSpan> spans_;
  const PhaseMaps& maps_;
  const RayDepth& rays_;
};

}  // namespace

double DepthRipple::rms_rad() const noexcept {
  double squares = 0;
  for (const PhaseRipple& r : of) {
    for (std::size_t m = 0; m < kRippleTerms; ++m) squares += r.cosine[m] * r.cosine[m] + r.sine[m] * r.sine[m];
  }
  return std::sqrt(squares / 2);
}

DepthRipple level_by_depth(std::span<const CellSpan> spans, const PhaseMaps& maps, const RayDepth& rays,
                           const PhaseMoments& moments, const PhaseRipple& mean) {
  DepthRipple out;
  if (!(moments.pixels > 0) || !stands_clear(mean, moments.pixels)) return out;
  const SpanDepths depths(spans, maps, rays);
  out.depth = orthonormal(depths.power_sums());
  const DepthPolynomials& p = out.depth;
  if (p.per_d > 0) {
    const PhaseMoments m = depths.moments(p, [&](double d) { return p.first(d); });
    out.of[0] = shrink(level(m), m);
  }
  if (p.scale > 0) {
    const PhaseMoments m = depths.moments(p, [&](double d) { return p.second(d); });
    out.of[1] = shrink(level(m), m);
  }
  return out;
}

void correct_by_depth(const DepthRipple& ripple, const Map<std::int16_t>& wraps, const RayDepth& rays,
                      PhaseMaps& maps) {
  if (!(ripple.depth.per_d > 0)) return;
  const auto width = static_cast<std::size_t>(rays.width);
  const DepthRippleTerms terms = float_terms(ripple);
  for (int v = 0; v < rays.height; ++v)
    correct_by_depth_row(terms, wraps, rays.phase_mid_rad.data(), static_cast<std::size_t>(v) * width, width, maps);
}

}  // namespace enamel::pipeline
