#include "pipeline/algo/decode/motion_samples.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/algo/decode/motion_images.hpp"
#include "pipeline/algo/phase/closure_rows.hpp"
#include "pipeline/algo/phase/poly_trig.hpp"

namespace enamel::algo {
namespace {

void take_pixel(const PhaseMaps& m, float weight, float black_dn, float max_residual, std::size_t i, std::size_t to,
                MotionSamples& out) {
  const float c = m.cosine_dn[i], s = m.sine_dn[i], b = m.modulation_dn[i], r = m.code_dn[i];
  const bool used = m.reject[i] == PixelReject::kNone && std::abs(weight) > 0.999F && std::abs(r) < max_residual * b;
  if (!used) return;
  const float light = m.mean_dn[i] - black_dn;
  const bool plus = weight > 0;
  out.rate[to] = plus ? 2 * (s - c) : -2 * c;
  out.rate_per_rate[to] = plus ? 2 * (s - c) : 2 * s;
  out.light[to] = plus ? -2 * (light + c + s) : 2 * (light - s);
  out.shared[to] = plus ? 4 * (c - s) * (c + s) / (b + 1e-6F) : 0;
  out.residual[to] = r;
  out.used[to] = 1;
}

}  // namespace

void place_samples(int width, int height, MotionSamples& out) {
  const int columns = width / kNode_px, rows = height / kNode_px;
  out.node.clear();
  for (int row = 1; row < rows - 1; ++row)
    for (int column = 2 - row % 2; column < columns - 1; column += 2) out.node.push_back(row * columns + column);
  out.nodes = (out.node.size() + kNodeLanes - 1) / kNodeLanes * kNodeLanes;
  for (auto* v : {&out.rate, &out.rate_per_rate, &out.light, &out.shared, &out.residual, &out.used})
    v->assign(kNodePixels * out.nodes, 0.0F);
}

void take_samples(const PhaseMaps& maps, const PolarityMaps& polarity, float black_dn, float max_residual,
                  MotionSamples& out) {
  const int columns = maps.phase_rad.width() / kNode_px;
  place_samples(maps.phase_rad.width(), maps.phase_rad.height(), out);
  for (std::size_t n = 0; n < out.node.size(); ++n) {
    const int top = out.node[n] / columns * kNode_px, left = out.node[n] % columns * kNode_px;
    std::size_t p = 0;
    for (int v = top; v < top + kNode_px; v += kPixelStep) {
      for (int u = left + v / kPixelStep % kPixelStep; u < left + kNode_px; u += kPixelStep, ++p) {
        const std::size_t i = maps.phase_rad.index(u, v);
        take_pixel(maps, polarity.weight[i], black_dn, max_residual, i, p * out.nodes + n, out);
      }
    }
  }
}

void take_sample_row(const PhaseMaps& maps, int v, const SampleRow& row, float max_residual, MotionSamples& out) {
  const int columns = maps.phase_rad.width() / kNode_px, node_row = v / kNode_px, line = v % kNode_px / kPixelStep;
  auto node = std::lower_bound(out.node.begin(), out.node.end(), node_row * columns);
  for (; node != out.node.end() && *node / columns == node_row; ++node) {
    const int left = *node % columns * kNode_px + v / kPixelStep % kPixelStep;
    for (int k = 0; k < kNode_px / kPixelStep; ++k) {
      const auto u = static_cast<std::size_t>(left + k * kPixelStep);
      const std::size_t i = maps.phase_rad.index(static_cast<int>(u), v);
      const float limit = max_residual * maps.modulation_dn[i];
      if (maps.reject[i] != PixelReject::kNone || !(std::abs(row.residual[u]) < limit)) continue;
      const std::size_t to = static_cast<std::size_t>(line * kNode_px / kPixelStep + k) * out.nodes +
                             static_cast<std::size_t>(node - out.node.begin());
      out.rate[to] = row.rate[u];
      out.light[to] = row.light[u];
      out.shared[to] = row.shared[u];
      out.residual[to] = row.residual[u] + row.rate[u] * row.known_rate[u] + row.light[u] * row.known_light[u];
      out.used[to] = 1;
    }
  }
}

void take_samples(const PhaseMaps& maps, const PolarityMaps& polarity, const BurstErrors& known, float black_dn,
                  float max_residual, MotionSamples& out) {
  const auto width = static_cast<std::size_t>(maps.phase_rad.width());
  place_samples(maps.phase_rad.width(), maps.phase_rad.height(), out);
  ErrorRows rows(known, black_dn, maps.phase_rad.width());
  std::vector<float> row(4 * width);
  float* r = row.data();
  for (int v = 0; v < maps.phase_rad.height(); v += kPixelStep) {
    const RowErrors e = rows.at(polarity, v);
    left_row(maps, e, maps.phase_rad.index(0, v), width, {r, r + width, r + 2 * width, r + 3 * width});
    take_sample_row(maps, v, {r, r + width, r + 2 * width, r + 3 * width, e.rate, e.light}, max_residual, out);
  }
}

}  // namespace enamel::algo
