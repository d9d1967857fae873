#include "host/accuracy/figures.hpp"

#include <algorithm>
#include <cmath>

#include "host/compare/percentile.hpp"

namespace enamel::host {
DeviationFigures figures_of(std::vector<double> deviation_um) {
  DeviationFigures out;
  out.count = deviation_um.size();
  if (deviation_um.empty()) return out;
  for (const double d : deviation_um) {
    out.mean_abs_um += std::abs(d);
    out.mean_um += d;
    out.rms_um += d * d;
  }
  const auto n = static_cast<double>(out.count);
  out.mean_abs_um /= n;
  out.mean_um /= n;
  out.rms_um = std::sqrt(out.rms_um / n);
  std::ranges::sort(deviation_um);
  out.half_80_um = 0.5 * (percentile(deviation_um, 0.9) - percentile(deviation_um, 0.1));
  for (double& d : deviation_um) d = std::abs(d);
  std::ranges::sort(deviation_um);
  out.p95_um = percentile(deviation_um, 0.95);
  return out;
}

double range_of(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  const double out = 0.5 * (1 - share);
  return percentile(values, 1 - out) - percentile(values, out);
}

Spread spread_of(std::span<const double> values) {
  Spread out;
  if (values.empty()) return out;
  const auto n = static_cast<double>(values.size());
  for (const double v : values) out.mean += v / n;
  if (values.size() < 2) return out;
  double squares = 0;
  for (const double v : values) squares += (v - out.mean) * (v - out.mean);
  out.sd = std::sqrt(squares / (n - 1));
  return out;
}

}  // namespace enamel::host
