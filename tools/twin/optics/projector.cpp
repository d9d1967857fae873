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
                               double far_mm)
    : config_(config), axis_v_(levels.axis_v) {
  const std::size_t n = levels.frames[0].size();
  constexpr double kSigmaFloor = 0.02;  // a sharp pixel edge, still resolved by the table
  sigma2_min_ = std::max(config.blur_sigma_px * config.blur_sigma_px, kSigmaFloor * kSigmaFloor);
  const double sigma2_max = std::max({sigma2_at(near_mm - 2.0), sigma2_at(far_mm + 2.0), sigma2_min_});
  constexpr double kBinWidth = 0.2;  // px^2
  bins_ = static_cast<std::size_t>(std::ceil((sigma2_max - sigma2_min_) / kBinWidth)) + 2;
  bins_per_unit_ = 1.0 / kBinWidth;
  bin_limit_ = static_cast<double>(bins_ - 2) + 0.999999;
  stride_ = static_cast<std::size_t>((static_cast<double>(n) + 2 * kMargin) * kFine) + 2;
  for (int frame = 0; frame < 4; ++frame) {
    std::vector<double> emission(n);
    for (std::size_t i = 0; i < n; ++i) {
      const double level = levels.frames[static_cast<std::size_t>(frame)][i];
      emission[i] = emission_of_level(config, config.round_levels ? std::nearbyint(level) : level);
    }
    tables_[static_cast<std::size_t>(frame)].resize(bins_ * stride_);
    tbb::parallel_for(std::size_t{0}, bins_, [&](std::size_t b) {
      fill(frame, b, std::sqrt(sigma2_min_ + kBinWidth * static_cast<double>(b)), emission);
    });
  }
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
