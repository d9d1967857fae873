#include "tools/twin/render/still_renderer.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "tools/twin/render/burst_renderer.hpp"

namespace enamel::twin {
namespace {

constexpr std::size_t kPixelsPerTask = 4096;
constexpr float kEdgeStep = 0.01F;  // of albedo: less is texture or rounding

StillSample sample_of(const Lane& lane) {
  return {lane.u, lane.v, static_cast<float>(lane.weight), static_cast<float>(lane.ambient),
          static_cast<float>(lane.sigma2)};
}

/// What of a sample makes an edge when it changes: nothing hit, ground, dot, shade.
float look_of(const Lane& lane) { return lane.hit ? (lane.lit ? 1.0F + lane.albedo : -lane.albedo) : -2.0F; }

}  // namespace

/// A row's base samples, pixel by pixel, and the span of looks within each pixel.
struct StillRenderer::Row {
  Samples samples;
  std::vector<float> low, high;
};

StillRenderer::StillRenderer(const Instrument& instrument, const RayScene& scene, const RenderConfig& config)
    : instrument_(instrument),
      tracer_(instrument, scene, config.light),
      width_(instrument.rig.camera.width),
      height_(instrument.rig.camera.height) {
  const SamplePattern base(config.grid), fine(kEdgeGrid);
  dx_ = base.dx;
  dy_ = base.dy;
  edge_dx_ = fine.dx;
  edge_dy_ = fine.dy;
}

void StillRenderer::trace_row(const View& view, int y, Row& row) const {
  const std::size_t w = static_cast<std::size_t>(width_), n = dx_.size();
  row.samples.assign(w * n, {});
  row.low.assign(w, 1e9F);
  row.high.assign(w, -1e9F);
  std::vector<double> directions(2 * w);
  Lanes8 lanes;
  for (std::size_t s = 0; s < n; ++s) {
    for (std::size_t x = 0; x < w; ++x) {
      const Eigen::Vector2d d = instrument_.camera.direction(static_cast<double>(x) + dx_[s], y + dy_[s]);
      directions[2 * x] = d.x();
      directions[2 * x + 1] = d.y();
    }
    for (std::size_t x0 = 0; x0 < w; x0 += kPacket) {
      const std::size_t count = std::min(kPacket, w - x0);
      tracer_.trace(view, directions.data() + 2 * x0, count, nullptr, lanes);
      for (std::size_t i = 0; i < count; ++i) {
        row.samples[(x0 + i) * n + s] = sample_of(lanes[i]);
        row.low[x0 + i] = std::min(row.low[x0 + i], look_of(lanes[i]));
        row.high[x0 + i] = std::max(row.high[x0 + i], look_of(lanes[i]));
      }
    }
  }
}

void StillRenderer::trace_edge_pixel(const View& view, int x, int y, Samples& out) const {
  const std::size_t n = edge_dx_.size();
  std::array<double, 2 * kPacket> directions{};
  Lanes8 lanes;
  for (std::size_t s0 = 0; s0 < n; s0 += kPacket) {
    const std::size_t count = std::min(kPacket, n - s0);
    for (std::size_t i = 0; i < count; ++i) {
      const Eigen::Vector2d d = instrument_.camera.direction(x + edge_dx_[s0 + i], y + edge_dy_[s0 + i]);
      directions[2 * i] = d.x();
      directions[2 * i + 1] = d.y();
    }
    tracer_.trace(view, directions.data(), count, nullptr, lanes);
    for (std::size_t i = 0; i < count; ++i) out.push_back(sample_of(lanes[i]));
  }
}

StillView StillRenderer::trace(const Pose& T_model_cam) const {
  const View at(instrument_, T_model_cam);
  const std::size_t w = static_cast<std::size_t>(width_), h = static_cast<std::size_t>(height_), n = dx_.size();
  std::vector<Row> rows(h);
  tbb::parallel_for(0, height_, [&](int y) { trace_row(at, y, rows[static_cast<std::size_t>(y)]); });
  std::vector<Samples> fine(h);  // edge pixels of a row, one after the other
  std::vector<std::vector<bool>> is_edge(h, std::vector<bool>(w));
  tbb::parallel_for(std::size_t{0}, h, [&](std::size_t y) {
    for (std::size_t x = 0; x < w; ++x) {
      float low = 1e9F, high = -1e9F;
      for (std::size_t v = y == 0 ? 0 : y - 1; v <= std::min(y + 1, h - 1); ++v) {
        for (std::size_t u = x == 0 ? 0 : x - 1; u <= std::min(x + 1, w - 1); ++u) {
          low = std::min(low, rows[v].low[u]);
          high = std::max(high, rows[v].high[u]);
        }
      }
      is_edge[y][x] = high - low > kEdgeStep;
      if (is_edge[y][x]) trace_edge_pixel(at, static_cast<int>(x), static_cast<int>(y), fine[y]);
    }
  });
  StillView out;
  out.first.reserve(w * h + 1);
  out.first.push_back(0);
  for (std::size_t y = 0; y < h; ++y) {
    auto next = fine[y].begin();
    for (std::size_t x = 0; x < w; ++x) {
      const bool edge = is_edge[y][x];
      const auto from = edge ? next : rows[y].samples.begin() + static_cast<std::ptrdiff_t>(x * n);
      const auto to = from + static_cast<std::ptrdiff_t>(edge ? edge_dx_.size() : n);
      out.samples.insert(out.samples.end(), from, to);
      if (edge) next = to;
      out.first.push_back(static_cast<std::uint32_t>(out.samples.size()));
    }
  }
  return out;
}

std::array<std::vector<float>, 4> StillRenderer::shade(const StillView& view, const ProjectorLight& light) {
  const std::size_t pixels = view.first.size() - 1;
  std::array<std::vector<float>, 4> out;
  for (auto& image : out) image.resize(pixels);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pixels, kPixelsPerTask), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      std::array<double, 4> sum{};
      for (std::uint32_t s = view.first[i]; s < view.first[i + 1]; ++s) {
        const StillSample& sample = view.samples[s];
        const auto weight = static_cast<double>(sample.weight), ambient = static_cast<double>(sample.ambient);
        if (!(weight > 0)) {
          for (double& each : sum) each += ambient;
          continue;
        }
        const auto tap = light.tap(light.axis_v() ? sample.v : sample.u, static_cast<double>(sample.sigma2));
        for (int k = 0; k < 4; ++k)
          sum[static_cast<std::size_t>(k)] += weight * static_cast<double>(light.emission(k, tap)) + ambient;
      }
      const double n = view.first[i + 1] - view.first[i];
      for (std::size_t k = 0; k < 4; ++k) out[k][i] = static_cast<float>(sum[k] / n);
    }
  });
  return out;
}

}  // namespace enamel::twin
