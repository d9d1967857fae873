#include "pipeline/decode/phase/noise_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include "pipeline/decode/phase/chosen.hpp"

namespace enamel::pipeline {
namespace {

constexpr int kBins = 16;                   // layout: of intensity
constexpr std::size_t kSubsample = 7;       // layout: odd and not a divisor of usual widths: visits all columns
constexpr double kRounding_dn2 = 1.0 / 12;  // physical: variance of rounding to whole numbers
constexpr float kMadToSigma = 1.4826F;      // derived: 1/0.6745, the upper quartile of a normal distribution

float load(const BurstView& view, std::size_t frame, std::size_t i) {
  const auto bytes = view.frames[frame];
  if (view.bit_depth == 8) return bytes[i];
  std::uint16_t value = 0;
  std::memcpy(&value, &bytes[2 * i], 2);
  return value;
}

/// |residual| in units of one frame's sigma, or a negative number where frame 3 does not show which of the two it is.
float closure_residual(float a, float s3, float i1, float i3) {
  const float d = i3 - a;
  if (std::abs(s3) < 4 || std::abs(d) < 0.5F * std::abs(s3)) return -1;
  return d * s3 > 0 ? std::abs(i3 + i1 - 2 * a) * 0.5F : std::abs(i3 - i1) * 0.70710678F;
}

}  // namespace

NoiseModel noise_from_rig(const calib::NoiseValues& noise, int bit_depth) {
  const double scale = (std::pow(2.0, bit_depth) - 1) / (std::pow(2.0, noise.bits) - 1);
  const double gain = noise.gain_e_per_dn / scale;
  const double read = noise.read_noise_e / gain;
  NoiseModel model;
  model.floor_dn2 = static_cast<float>(read * read + 1.0 / 12);
  model.slope_dn = static_cast<float>(1 / gain);
  model.black_dn = static_cast<float>(noise.black_dn * scale);
  model.full_scale_dn = static_cast<float>((1 << bit_depth) - 1);
  return model;
}

NoiseModel noise_from_closure(const BurstView& view) {
  NoiseModel model;
  model.source = NoiseSource::kClosure;
  model.full_scale_dn = static_cast<float>((1 << view.bit_depth) - 1);
  std::array<std::vector<float>, kBins> bins;
  const std::size_t n = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
  for (std::size_t i = 0; i < n; i += kSubsample) {
    const float i0 = load(view, 0, i), i1 = load(view, 1, i), i2 = load(view, 2, i), i3 = load(view, 3, i);
    if (std::max({i0, i1, i2, i3}) > 0.97F * model.full_scale_dn) continue;
    const float a = 0.5F * (i0 + i2);
    const float r = closure_residual(a, a - i1, i1, i3);
    if (r < 0) continue;
    bins[static_cast<std::size_t>(std::clamp(a / model.full_scale_dn, 0.0F, 0.999F) * kBins)].push_back(r);
  }
  double w = 0, wx = 0, wy = 0, wxx = 0, wxy = 0;
  for (std::size_t b = 0; b < kBins; ++b) {
    auto& r = bins[b];
    if (r.size() < kMinBinPixels) continue;
    std::nth_element(r.begin(), r.begin() + static_cast<std::ptrdiff_t>(r.size() / 2), r.end());
    const double sigma = static_cast<double>(kMadToSigma * r[r.size() / 2]);
    const double x = (static_cast<double>(b) + 0.5) / kBins * static_cast<double>(model.full_scale_dn);
    const double weight = static_cast<double>(r.size()), y = sigma * sigma;
    w += weight, wx += weight * x, wy += weight * y, wxx += weight * x * x, wxy += weight * x * y;
  }
  // Too little spread of intensity for a line: shot noise through the rounding floor.
  const double det = w * wxx - wx * wx, narrow = 0.05 * static_cast<double>(model.full_scale_dn) * w;
  double slope = det > narrow * narrow ? std::max(0.0, (w * wxy - wx * wy) / det) : -1;
  double floor = w > 0 && slope >= 0 ? (wy - slope * wx) / w : 0;
  if (floor < kRounding_dn2) {
    floor = kRounding_dn2;
    slope = wx > 0 ? std::max(0.0, (wy - floor * w) / wx) : 1.0;
  }
  model.floor_dn2 = static_cast<float>(floor);
  model.slope_dn = static_cast<float>(slope);
  return model;
}

}  // namespace enamel::pipeline
