#include "pipeline/register/feature/masked_means.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace enamel::pipeline {
namespace {

/// Box sum over 2*radius+1 along one direction by prefix sums, zeros beyond the border.
Map<double> box_sum(const Map<double>& in, int radius, bool along_u) {
  Map<double> out(in.width(), in.height(), 0.0);
  const int length = along_u ? in.width() : in.height();
  const int lines = along_u ? in.height() : in.width();
  std::vector<double> prefix(static_cast<std::size_t>(length) + 1, 0.0);
  for (int line = 0; line < lines; ++line) {
    for (int k = 0; k < length; ++k) {
      prefix[static_cast<std::size_t>(k) + 1] =
          prefix[static_cast<std::size_t>(k)] + (along_u ? in(k, line) : in(line, k));
    }
    for (int k = 0; k < length; ++k) {
      const auto low = static_cast<std::size_t>(std::max(0, k - radius));
      const auto high = static_cast<std::size_t>(std::min(length, k + radius + 1));
      (along_u ? out(k, line) : out(line, k)) = prefix[high] - prefix[low];
    }
  }
  return out;
}

}  // namespace

Masked block_means(const Map<float>& in, int step) {
  const int width = in.width() / step;
  const int height = in.height() / step;
  Masked out{Map<double>(width, height, 0.0), Map<double>(width, height, 0.0)};
  for (int v = 0; v < height * step; ++v) {
    for (int u = 0; u < width * step; ++u) {
      const float x = in(u, v);
      if (!std::isfinite(x)) continue;
      out.value(u / step, v / step) += static_cast<double>(x);
      out.weight(u / step, v / step) += 1;
    }
  }
  for (std::size_t i = 0; i < out.value.size(); ++i) {
    if (out.weight[i] <= 0) continue;
    out.value[i] /= out.weight[i];
    out.weight[i] = 1;
  }
  return out;
}

Masked lowpass(const Masked& in, int radius) {
  Masked sums{Map<double>(in.value.width(), in.value.height(), 0.0), in.weight};
  for (std::size_t i = 0; i < in.value.size(); ++i) sums.value[i] = in.value[i] * in.weight[i];
  for (int pass = 0; pass < 4; ++pass) {
    sums.value = box_sum(sums.value, radius, pass % 2 == 0);
    sums.weight = box_sum(sums.weight, radius, pass % 2 == 0);
  }
  for (std::size_t i = 0; i < sums.value.size(); ++i) sums.value[i] /= std::max(sums.weight[i], 1.0);
  return sums;
}

int block_px(const SurfacePatch& patch, const ImageConfig& config) {
  return std::max(1,
                  static_cast<int>(std::lround(static_cast<double>(patch.depth_mm.width()) / config.target_width_px)));
}

int lowpass_radius(int step, double px_per_mm, const ImageConfig& config) {
  return std::max(1, static_cast<int>(std::lround(0.5 * config.lowpass_mm * px_per_mm / step)));
}

double brightness_of(double dn, double around_dn) { return dn / std::max(around_dn, 4.0) - 1; }

std::uint8_t to_grey(double x) {
  return static_cast<std::uint8_t>(std::clamp(std::floor(128.5 + 127 * x), 0.0, 255.0));
}

}  // namespace enamel::pipeline
