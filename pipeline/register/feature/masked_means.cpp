#include "pipeline/register/feature/masked_means.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace enamel::pipeline {
namespace {

/// Sums over 2*radius+1 neighbours by prefix sums, zeros beyond the border. `prefix` is scratch.
void sum_along_u(Map<double>& map, int radius, std::vector<double>& prefix) {
  const int length = map.width();
  prefix.assign(static_cast<std::size_t>(length) + 1, 0.0);
  for (int v = 0; v < map.height(); ++v) {
    double* row = &map(0, v);
    double sum = 0;
    for (int k = 0; k < length; ++k) prefix[static_cast<std::size_t>(k) + 1] = sum += row[k];
    const auto between = [&](int low, int high) {
      return prefix[static_cast<std::size_t>(high)] - prefix[static_cast<std::size_t>(low)];
    };
    const int inner = std::min(radius, length), end = std::max(inner, length - radius);
    for (int k = 0; k < inner; ++k) row[k] = between(0, std::min(length, k + radius + 1));
    for (int k = inner; k < end; ++k) row[k] = between(k - radius, std::min(length, k + radius + 1));
    for (int k = end; k < length; ++k) row[k] = between(k - radius, length);
  }
}

/// A whole row at a time. prefix: of the rows above, and the map's own.
void sum_along_v(Map<double>& map, int radius, std::vector<double>& prefix) {
  const auto width = static_cast<std::size_t>(map.width());
  const int height = map.height();
  prefix.assign(width * (static_cast<std::size_t>(height) + 1), 0.0);
  for (std::size_t i = 0; i < map.size(); ++i) prefix[i + width] = prefix[i] + map[i];
  for (int v = 0; v < height; ++v) {
    const double* low = &prefix[width * static_cast<std::size_t>(std::max(0, v - radius))];
    const double* high = &prefix[width * static_cast<std::size_t>(std::min(height, v + radius + 1))];
    double* row = &map(0, v);
    for (std::size_t u = 0; u < width; ++u) row[u] = high[u] - low[u];
  }
}

/// Adds a row of pixels to the row of blocks that it belongs to.
void add_row(const float* in, int step, int width, double* value, double* weight) {
  for (int i = 0; i < width; ++i) {
    for (int k = 0; k < step; ++k) {
      const float x = in[i * step + k];
      const bool known = std::isfinite(x);
      value[i] += known ? static_cast<double>(x) : 0.0;
      weight[i] += known ? 1.0 : 0.0;
    }
  }
}

}  // namespace

Masked block_means(const Map<float>& in, int step) {
  const int width = in.width() / step;
  const int height = in.height() / step;
  Masked out{Map<double>(width, height, 0.0), Map<double>(width, height, 0.0)};
  if (out.value.empty()) return out;
  for (int v = 0; v < height * step; ++v)
    add_row(&in(0, v), step, width, &out.value(0, v / step), &out.weight(0, v / step));
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
  if (sums.value.empty()) return sums;
  std::vector<double> prefix;
  for (int pass = 0; pass < 4; ++pass) {
    for (Map<double>* map : {&sums.value, &sums.weight}) {
      if (pass % 2 == 0) {
        sum_along_u(*map, radius, prefix);
      } else {
        sum_along_v(*map, radius, prefix);
      }
    }
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
