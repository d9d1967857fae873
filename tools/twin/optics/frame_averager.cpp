#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "tools/twin/optics/random.hpp"
#include "tools/twin/optics/sensor.hpp"

namespace enamel::twin {
namespace {

constexpr double kDeviateReach = 6, kDeviateStep = 0.05;  // of the photon noise, standard deviations

double normal_cdf(double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); }

/// Mean and mean square of the converter's output for `e` electrons before read noise.
SampleMoments raw_moments_of(double e, const SensorConfig& c) {
  const double top = std::ldexp(1.0, c.bits) - 1.0;
  const double dn = c.black_dn + e / c.gain_e_per_dn;
  const double sigma = c.read_noise ? c.read_noise_e / c.gain_e_per_dn : 0;
  constexpr double kSmooth = 1.5;  // DN; wider noise than this hides the converter's steps to 1e-9 of one
  if (sigma > kSmooth) return {dn, dn * dn + sigma * sigma + 1.0 / 12};
  if (sigma <= 0) {
    const double out = std::clamp(std::nearbyint(dn), 0.0, top);
    return {out, out * out};
  }
  const double first = std::clamp(std::floor(dn - kDeviateReach * sigma), 0.0, top);
  const double last = std::clamp(std::ceil(dn + kDeviateReach * sigma), first, top);
  SampleMoments sum;
  double below = 0;
  for (double d = first; d <= last; ++d) {
    const double upto = d < last ? normal_cdf((d + 0.5 - dn) / sigma) : 1.0;
    sum.mean += (upto - below) * d;
    sum.variance += (upto - below) * d * d;
    below = upto;
  }
  return sum;
}

/// Over the photon noise, by the same normal with skewness term that single exposures draw from.
SampleMoments integrate(double mean_e, const SensorConfig& c) {
  if (!c.shot_noise || mean_e <= 0) {
    const SampleMoments m = raw_moments_of(std::min(mean_e, c.full_well_e), c);
    return {m.mean, m.variance - m.mean * m.mean};
  }
  double weights = 0, first = 0, second = 0;
  for (double g = -kDeviateReach; g <= kDeviateReach; g += kDeviateStep) {
    const double w = std::exp(-0.5 * g * g);
    const double e = std::max(0.0, mean_e + std::sqrt(mean_e) * g + (g * g - 1.0) / 6.0);
    const SampleMoments m = raw_moments_of(std::min(e, c.full_well_e), c);
    weights += w;
    first += w * m.mean;
    second += w * m.variance;
  }
  first /= weights;
  return {first, second / weights - first * first};
}

}  // namespace

FrameAverager::FrameAverager(const SensorConfig& config, int frames) : config_(config), frames_(frames) {
  constexpr std::size_t kEntries = 4096;
  step_e_ = 1.25 * config.full_well_e / static_cast<double>(kEntries - 1);
  table_.resize(kEntries);
  tbb::parallel_for(std::size_t{0}, kEntries,
                    [&](std::size_t i) { table_[i] = integrate(step_e_ * static_cast<double>(i), config_); });
}

SampleMoments FrameAverager::moments(double mean_e) const {
  const double at = std::clamp(mean_e / step_e_, 0.0, static_cast<double>(table_.size() - 2) + 0.999999);
  const auto i = static_cast<std::size_t>(at);
  const double f = at - static_cast<double>(i);
  const SampleMoments &a = table_[i], &b = table_[i + 1];
  return {a.mean + f * (b.mean - a.mean), a.variance + f * (b.variance - a.variance)};
}

std::vector<float> FrameAverager::average(const std::vector<float>& electrons, const ExposureId& id) const {
  const CounterRandom random(id.seed, id.burst * 8U + static_cast<std::uint64_t>(id.frame));
  std::vector<float> out(electrons.size());
  constexpr std::size_t kPairsPerTask = 4096;
  const std::size_t pairs = (electrons.size() + 1) / 2;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pairs, kPairsPerTask), [&](const auto& range) {
    for (std::size_t j = range.begin(); j < range.end(); ++j) {
      const NormalPair g = random.normals(j);
      for (std::size_t i = 2 * j; i < std::min(2 * j + 2, electrons.size()); ++i) {
        const SampleMoments m = moments(static_cast<double>(electrons[i]));
        const double deviate = i % 2 == 0 ? g.a : g.b;
        out[i] = static_cast<float>(m.mean + std::sqrt(std::max(0.0, m.variance) / frames_) * deviate);
      }
    }
  });
  return out;
}

}  // namespace enamel::twin
