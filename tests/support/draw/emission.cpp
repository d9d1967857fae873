#include "tests/support/draw/emission.hpp"

#include <cmath>
#include <numbers>
#include <numeric>

namespace enamel::test {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kFarthest_mm = 11;  ///< from the focus; what lies farther is as blurred as there

/// The level that the pattern set has at projector column i, as an 8-bit projector takes it.
double level(const calib::PatternValues& p, int frame, int i) {
  const double phi = kTurn * i / p.period_px;
  double wave = std::cos(phi + frame * kTurn / 4);
  if (p.mode == calib::PatternMode::kMicro) {
    wave = frame == 1 ? std::cos(phi + phi / p.code_ratio) : std::cos(phi + (frame == 0 ? 0 : frame - 1) * kTurn / 3);
  } else if (frame == 3) {
    const auto cell =
        static_cast<std::size_t>(std::floor(2 * i / p.period_px + 1e-9)) + static_cast<std::size_t>(p.first_cell);
    wave = p.polarity_code[cell % p.polarity_code.size()] * std::sin(phi);
  }
  return std::floor(p.mean + p.amplitude * wave + 0.5 + 1e-9);
}

}  // namespace

Emission::Emission(const Drawn& drawn) : drawn_(drawn) {
  const int width = drawn.rig.projector.width;
  points_ = static_cast<std::size_t>((width + 2 * kMargin_px) * kPerPixel);
  const double farthest = drawn.optics.blur_px_per_mm * kFarthest_mm;
  step_px2_ = farthest * farthest / (kSigmas - 1);
  for (std::size_t k = 0; k < 4; ++k) {
    for (int i = 0; i < width; ++i)
      emitted_[k].push_back(drawn.response.emission(level(drawn.rig.patterns, static_cast<int>(k), i)));
    mean_[k] = std::accumulate(emitted_[k].begin(), emitted_[k].end(), 0.0) / width;
    table_[k].assign(points_ * kSigmas, 0);
    for (std::size_t s = 0; s < kSigmas; ++s) {
      const double blur = drawn.optics.blur_px, variance = blur * blur + static_cast<double>(s) * step_px2_;
      tabulate(k, s, std::sqrt(variance));
    }
  }
}

/// Square pixels under a Gaussian: each weighs what the Gaussian has over it.
void Emission::tabulate(std::size_t frame, std::size_t blur, double sigma_px) {
  const auto& emitted = emitted_[frame];
  const int width = static_cast<int>(emitted.size()), reach = static_cast<int>(std::ceil(4.5 * sigma_px)) + 1;
  const auto below = [&](double x) { return 0.5 * std::erfc(-x / (sigma_px * std::numbers::sqrt2)); };
  for (int part = 0; part < kPerPixel; ++part) {
    std::vector<double> weight;
    for (int j = -reach; j <= reach; ++j) {
      const double from = j - static_cast<double>(part) / kPerPixel;
      weight.push_back(below(from + 0.5) - below(from - 0.5));
    }
    for (int i = -kMargin_px; i < width + kMargin_px; ++i) {
      double sum = 0;
      for (int j = std::max(-reach, -i); j <= std::min(reach, width - 1 - i); ++j)
        sum += weight[static_cast<std::size_t>(j + reach)] * emitted[static_cast<std::size_t>(i + j)];
      const auto at = static_cast<std::size_t>((i + kMargin_px) * kPerPixel + part);
      table_[frame][blur * points_ + at] = static_cast<float>(sum);
    }
  }
}

}  // namespace enamel::test
