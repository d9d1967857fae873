#include "tools/twin/optics/sensor.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "tools/twin/optics/random.hpp"

namespace enamel::twin {
namespace {

constexpr int kRowsPerTask = 16;

std::vector<float> gaussian_kernel(double sigma) {
  const int reach = static_cast<int>(std::ceil(4.0 * sigma));
  std::vector<double> k;
  double sum = 0;
  for (int i = -reach; i <= reach; ++i) {
    k.push_back(std::exp(-0.5 * i * i / (sigma * sigma)));
    sum += k.back();
  }
  std::vector<float> out;
  out.reserve(k.size());
  for (const double v : k) out.push_back(static_cast<float>(v / sum));
  return out;
}

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Where sample i of a line of n is read, and for one beyond the line the edge that it is mirrored at: the light is
/// taken to go on in a straight line there, f(-i) = 2 f(0) - f(i), so that a fringe cut by the border keeps its phase.
struct Source {
  int at, edge;
  bool beyond;
};

Source source_of(int i, int n) {
  if (i >= 0 && i < n) return {i, i, false};
  const int edge = i < 0 ? 0 : n - 1;
  return {std::clamp(2 * edge - i, 0, n - 1), edge, true};
}

void blur_row(const float* in, float* out, int n, const std::vector<float>& kernel) {
  const int reach = static_cast<int>(kernel.size()) / 2;
  for (int x = 0; x < n; ++x) {
    float sum = 0;
    if (x >= reach && x + reach < n) {
      for (int i = -reach; i <= reach; ++i) sum += kernel[at(i + reach)] * in[x + i];
    } else {
      for (int i = -reach; i <= reach; ++i) {
        const Source s = source_of(x + i, n);
        sum += kernel[at(i + reach)] * (s.beyond ? std::max(0.0F, 2 * in[s.edge] - in[s.at]) : in[s.at]);
      }
    }
    out[x] = sum;
  }
}

void blur_column_row(const std::vector<float>& in, std::vector<float>& out, int width, int height, int y,
                     const std::vector<float>& kernel) {
  const int reach = static_cast<int>(kernel.size()) / 2;
  const auto line = [&](int v) { return in.data() + static_cast<std::ptrdiff_t>(v) * width; };
  float* row = out.data() + static_cast<std::ptrdiff_t>(y) * width;
  std::fill(row, row + width, 0.0F);
  for (int i = -reach; i <= reach; ++i) {
    const float w = kernel[at(i + reach)];
    const Source s = source_of(y + i, height);
    const float* src = line(s.at);
    const float* edge = line(s.edge);
    if (s.beyond) {
      for (int x = 0; x < width; ++x) row[x] += w * std::max(0.0F, 2 * edge[x] - src[x]);
    } else {
      for (int x = 0; x < width; ++x) row[x] += w * src[x];
    }
  }
}

/// Poisson deviate. Small means exactly, by counting exponential steps; large ones by the normal with the skewness term
/// of Cornish and Fisher (error of the third moment < 1 % above 50).
double poisson(double mean, double normal, const CounterRandom& rng, std::uint64_t counter) {
  constexpr double kNormalFrom = 50;
  if (mean <= 0) return 0;
  if (mean >= kNormalFrom) {
    return std::max(0.0, std::nearbyint(mean + std::sqrt(mean) * normal + (normal * normal - 1.0) / 6.0));
  }
  const double limit = std::exp(-mean);
  double product = 1;
  for (int n = 0;; ++n) {
    product *= rng.uniform((counter << 12U) + static_cast<std::uint64_t>(n));
    if (product <= limit) return n;
  }
}

struct Converter {
  const SensorConfig& config;
  CounterRandom rng, small;

  [[nodiscard]] double sample(double mean_e, std::uint64_t pixel) const {
    double e = mean_e;
    if (config.shot_noise || config.read_noise) {
      const NormalPair g = rng.normals(pixel);
      if (config.shot_noise) e = poisson(mean_e, g.a, small, pixel);
      e = std::min(e, config.full_well_e);
      if (config.read_noise) e += config.read_noise_e * g.b;
    }
    e = std::min(e, config.full_well_e + 10 * config.read_noise_e);
    const double top = std::ldexp(1.0, config.bits) - 1.0;
    return std::clamp(std::nearbyint(config.black_dn + e / config.gain_e_per_dn), 0.0, top);
  }
};

}  // namespace

void apply_psf(std::vector<float>& image, int width, int height, double sigma_px) {
  if (sigma_px <= 0) return;
  const auto kernel = gaussian_kernel(sigma_px);
  std::vector<float> rows(image.size());
  tbb::parallel_for(tbb::blocked_range<int>(0, height, kRowsPerTask), [&](const auto& range) {
    for (int y = range.begin(); y < range.end(); ++y) {
      const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(y) * width;
      blur_row(image.data() + first, rows.data() + first, width, kernel);
    }
  });
  tbb::parallel_for(tbb::blocked_range<int>(0, height, kRowsPerTask), [&](const auto& range) {
    for (int y = range.begin(); y < range.end(); ++y) blur_column_row(rows, image, width, height, y, kernel);
  });
}

std::vector<std::uint8_t> digitise(const std::vector<float>& electrons, const SensorConfig& config,
                                   const ExposureId& id) {
  const std::uint64_t stream = id.burst * 8U + static_cast<std::uint64_t>(id.frame);
  const Converter convert{config, CounterRandom(id.seed, stream), CounterRandom(~id.seed, stream)};
  const bool wide = config.bits > 8;
  std::vector<std::uint8_t> out(electrons.size() * (wide ? 2U : 1U));
  constexpr std::size_t kPixelsPerTask = 8192;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, electrons.size(), kPixelsPerTask), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const auto dn = static_cast<std::uint32_t>(convert.sample(static_cast<double>(electrons[i]), i));
      if (wide) {
        out[2 * i] = static_cast<std::uint8_t>(dn & 0xFFU);
        out[2 * i + 1] = static_cast<std::uint8_t>(dn >> 8U);
      } else {
        out[i] = static_cast<std::uint8_t>(dn);
      }
    }
  });
  return out;
}

}  // namespace enamel::twin
