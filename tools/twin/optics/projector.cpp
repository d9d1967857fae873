#include "tools/twin/optics/projector.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace enamel::twin {
namespace {

/// Integral of the standard normal up to x.
double lit_share(double x) { return 0.5 * std::erfc(-x * std::numbers::sqrt2 / 2.0); }

}  // namespace

double emission_of_level(const ProjectorConfig& config, double level) {
  double x = std::clamp(level / 255.0, 0.0, 1.0);
  if (config.lut_gamma != 1.0) {
    x = std::pow(x, 1.0 / config.lut_gamma);
    if (config.round_levels) x = std::nearbyint(x * 255.0) / 255.0;
  }
  if (config.gamma != 1.0) x = std::pow(x, config.gamma);
  return config.black_fraction + (1.0 - config.black_fraction) * x;
}

ProjectorLight::ProjectorLight(const calib::PatternLevels& levels, const ProjectorConfig& config, double near_mm,
                               double far_mm, double spread_px)
    : config_(config), axis_v_(levels.axis_v), pixels_(levels.frames[0].size()) {
  const std::size_t n = pixels_;
  constexpr double kSigmaFloor = 0.02;  // a sharp pixel edge, still resolved by the table
  sigma2_min_ = std::max(config.blur_sigma_px * config.blur_sigma_px, kSigmaFloor * kSigmaFloor);
  const double sigma2_max = std::max({sigma2_at(near_mm - 2.0), sigma2_at(far_mm + 2.0), sigma2_min_});
  constexpr double kBinWidth = 0.2;  // px^2
  bins_ = static_cast<std::size_t>(std::ceil((sigma2_max - sigma2_min_) / kBinWidth)) + 2;
  bins_per_unit_ = 1.0 / kBinWidth;
  bin_limit_ = static_cast<double>(bins_ - 2) + 0.999999;
  stride_ = static_cast<std::size_t>((static_cast<double>(n) + 2 * kMargin) * kFine) + 2;
  sigma2_top_ = sigma2_max;
  std::array<std::vector<double>, 4> emissions;
  for (int frame = 0; frame < 4; ++frame) {
    auto& emission = emissions[static_cast<std::size_t>(frame)];
    emission.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      const double level = levels.frames[static_cast<std::size_t>(frame)][i];
      emission[i] = emission_of_level(config, config.round_levels ? std::nearbyint(level) : level);
    }
    tables_[static_cast<std::size_t>(frame)].resize(bins_ * stride_);
    tbb::parallel_for(std::size_t{0}, bins_, [&](std::size_t b) {
      fill(frame, b, std::sqrt(sigma2_min_ + kBinWidth * static_cast<double>(b)), emission);
    });
  }
  if (spread_px > 0) fill_wide(sigma2_max + spread_px * spread_px, emissions);
}

namespace {

/// Octaves of x, straight within each: log2 to 9 %, and a table over it is linear in x from bin to bin.
double octaves(double x) {
  int exponent = 0;
  const double mantissa = std::frexp(x, &exponent);
  return exponent + 2.0 * mantissa - 1.0;
}
double of_octaves(double o) {
  const double whole = std::floor(o);
  return std::ldexp(0.5 * (o - whole + 1.0), static_cast<int>(whole));
}

}  // namespace

float ProjectorLight::blurred(int frame, double p, double sigma2) const {
  if (wide_.bins == 0 || sigma2 <= sigma2_top_) {
    const double last = static_cast<double>(pixels_) + kMargin - 0.5;
    return emission(frame, tap(std::clamp(p, -kMargin, last), sigma2));
  }
  const double most = static_cast<double>(wide_.stride) - 1.001;
  const double x = std::clamp((p + kWideMargin) * kWideFine, 0.0, most);
  const double b = std::clamp((octaves(sigma2) - wide_.first) * kWideBins, 0.0, wide_.bin_limit);
  const auto ix = static_cast<std::size_t>(x), ib = static_cast<std::size_t>(b);
  const auto fx = static_cast<float>(x - static_cast<double>(ix)), fb = static_cast<float>(b - static_cast<double>(ib));
  const float* low = wide_.tables[static_cast<std::size_t>(frame)].data() + ib * wide_.stride + ix;
  const float* high = low + wide_.stride;
  const float lo = low[0] + fx * (low[1] - low[0]), hi = high[0] + fx * (high[1] - high[0]);
  return lo + fb * (hi - lo);
}

/// As fill(), at fewer places: a blur of many pixels has nothing finer. Bins a ratio r apart cost 0.07 (r - 1)^2 of the
/// amplitude by linear interpolation, here 1e-3; places a quarter pixel apart cost 3e-4.
void ProjectorLight::fill_wide(double sigma2_max, const std::array<std::vector<double>, 4>& emission) {
  constexpr double kReachSigmas = 4.5;
  wide_.first = octaves(sigma2_top_);
  wide_.bins = static_cast<std::size_t>(std::ceil((octaves(sigma2_max) - wide_.first) * kWideBins)) + 2;
  wide_.bin_limit = static_cast<double>(wide_.bins - 2) + 0.999999;
  wide_.stride = static_cast<std::size_t>((static_cast<double>(pixels_) + 2 * kWideMargin) * kWideFine) + 2;
  for (auto& table : wide_.tables) table.resize(wide_.bins * wide_.stride);
  const auto n = static_cast<long>(pixels_);
  const auto fine = static_cast<std::size_t>(kWideFine);
  tbb::parallel_for(std::size_t{0}, wide_.bins, [&](std::size_t bin) {
    const double sigma = std::sqrt(of_octaves(wide_.first + static_cast<double>(bin) / kWideBins));
    const long reach = static_cast<long>(std::ceil(kReachSigmas * sigma)) + 1;
    std::vector<double> shares(static_cast<std::size_t>(2 * reach + 1));
    for (std::size_t at = 0; at < wide_.stride * fine; ++at) {
      // All places of one offset within their pixel follow each other: they share the weights.
      const std::size_t offset = at / wide_.stride, step = at % wide_.stride;
      if (step == 0) {
        for (long j = -reach; j <= reach; ++j) {
          const double d = static_cast<double>(j) - static_cast<double>(offset) / kWideFine;
          shares[static_cast<std::size_t>(j + reach)] = lit_share((d + 0.5) / sigma) - lit_share((d - 0.5) / sigma);
        }
      }
      const std::size_t place = step * fine + offset;
      if (place >= wide_.stride) continue;
      const long pixel = static_cast<long>(step) - static_cast<long>(kWideMargin);
      std::array<double, 4> sum{};
      for (long i = std::max(0L, pixel - reach); i <= std::min(n - 1, pixel + reach); ++i) {
        const double share = shares[static_cast<std::size_t>(i - pixel + reach)];
        for (std::size_t k = 0; k < 4; ++k) sum[k] += share * emission[k][static_cast<std::size_t>(i)];
      }
      for (std::size_t k = 0; k < 4; ++k) wide_.tables[k][bin * wide_.stride + place] = static_cast<float>(sum[k]);
    }
  });
}

void ProjectorLight::fill(int frame, std::size_t bin, double sigma, const std::vector<double>& emission) {
  // Square pixels blurred by a Gaussian: pixel j adds E_j * (Phi(b) - Phi(a)) between its edges. Weights depend on the
  // fraction of the pixel only, so one row of them serves every pixel.
  const auto n = static_cast<long>(emission.size());
  const long reach = static_cast<long>(std::ceil(6.0 * sigma)) + 1;
  const auto fine = static_cast<long>(kFine);
  std::vector<double> weights(static_cast<std::size_t>(2 * reach + 1));
  float* out = tables_[static_cast<std::size_t>(frame)].data() + bin * stride_;
  for (long f = 0; f < fine; ++f) {
    const double offset = static_cast<double>(f) / kFine;
    for (long j = -reach; j <= reach; ++j) {
      const double d = static_cast<double>(j) - offset;
      weights[static_cast<std::size_t>(j + reach)] = lit_share((d + 0.5) / sigma) - lit_share((d - 0.5) / sigma);
    }
    for (std::size_t at = static_cast<std::size_t>(f); at < stride_; at += static_cast<std::size_t>(fine)) {
      const long pixel = static_cast<long>(at) / fine - static_cast<long>(kMargin);
      double sum = 0;
      for (long j = -reach; j <= reach; ++j) {
        const long i = pixel + j;
        if (i >= 0 && i < n)
          sum += weights[static_cast<std::size_t>(j + reach)] * emission[static_cast<std::size_t>(i)];
      }
      out[at] = static_cast<float>(sum);
    }
  }
}

}  // namespace enamel::twin
