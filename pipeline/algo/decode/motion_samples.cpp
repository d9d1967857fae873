#include "pipeline/algo/decode/motion_samples.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/algo/decode/motion_images.hpp"
#include "pipeline/algo/decode/motion_rows.hpp"
#include "pipeline/algo/phase/closure_rows.hpp"

namespace enamel::algo {

static_assert(kPixelStep == static_cast<int>(kSparseStep));
static_assert(kNode_px / kPixelStep == static_cast<int>(kGatheredRun));

void place_samples(int width, int height, MotionSamples& out) {
  const int columns = width / kNode_px, rows = height / kNode_px;
  out.node.clear();
  for (int row = 1; row < rows - 1; ++row)
    for (int column = 2 - row % 2; column < columns - 1; column += 2) out.node.push_back(row * columns + column);
  out.nodes = (out.node.size() + kNodeLanes - 1) / kNodeLanes * kNodeLanes;
  for (auto* v : {&out.rate, &out.rate_per_rate, &out.light, &out.shared, &out.residual, &out.used})
    v->assign(kNodePixels * out.nodes, 0.0F);
}

std::span<const std::int32_t> nodes_of_row(const MotionSamples& samples, int columns, int node_row) {
  const auto first = std::lower_bound(samples.node.begin(), samples.node.end(), node_row * columns);
  return {first, std::lower_bound(first, samples.node.end(), (node_row + 1) * columns)};
}

GatheredRuns runs_of_row(const MotionSamples& samples, int columns, int v) {
  const auto nodes = nodes_of_row(samples, columns, v / kNode_px);
  if (nodes.empty()) return {};
  const int first = nodes.front() % columns * kNode_px + first_column(v);
  return {static_cast<std::size_t>(first), 2 * kNode_px, nodes.size()};
}

void take_samples(const PhaseMaps& maps, const PolarityMaps& polarity, float black_dn, float max_residual,
                  MotionSamples& out) {
  place_samples(maps.phase_rad.width(), maps.phase_rad.height(), out);
  const int columns = maps.phase_rad.width() / kNode_px;
  ClosureRows rows;
  for (int v = 0; v < maps.phase_rad.height(); v += kPixelStep) {
    const GatheredRuns runs = runs_of_row(out, columns, v);
    if (runs.count == 0) continue;
    const std::size_t at = maps.phase_rad.index(0, v);
    const ClosureRow row = rows.of(maps, &polarity.weight[at], black_dn, max_residual, at, runs);
    const std::int32_t* first = nodes_of_row(out, columns, v / kNode_px).data();
    const auto node = static_cast<std::size_t>(first - out.node.data());
    const auto line = static_cast<std::size_t>(v % kNode_px / kPixelStep);
    for (std::size_t n = 0; n < runs.count; ++n) {
      for (std::size_t k = 0; k < kGatheredRun; ++k) {
        const std::size_t to = out.place(line * kGatheredRun + k, node + n), from = n * kGatheredRun + k;
        out.rate[to] = row.rate[from], out.rate_per_rate[to] = row.rate_per_rate[from];
        out.light[to] = row.light[from], out.shared[to] = row.shared[from];
        out.residual[to] = row.residual[from], out.used[to] = row.used[from];
      }
    }
  }
}

void take_sample_row(const PhaseMaps& maps, int v, const SampleRow& row, float max_residual, MotionSamples& out) {
  const int columns = maps.phase_rad.width() / kNode_px, node_row = v / kNode_px, line = v % kNode_px / kPixelStep;
  std::size_t asked = 0;
  for (const std::int32_t& node : nodes_of_row(out, columns, node_row)) {
    const int left = node % columns * kNode_px + first_column(v);
    for (int k = 0; k < kNode_px / kPixelStep; ++k, ++asked) {
      const int column = left + k * kPixelStep;
      const auto x = static_cast<std::size_t>(column);
      const std::size_t u = asked;
      const std::size_t i = maps.phase_rad.index(column, v);
      const float limit = max_residual * maps.modulation_dn[i];
      if (maps.reject[i] != PixelReject::kNone || !(std::abs(row.residual[u]) < limit)) continue;
      const std::size_t to = out.place(static_cast<std::size_t>(line * kNode_px / kPixelStep + k),
                                       static_cast<std::size_t>(&node - out.node.data()));
      out.rate[to] = row.rate[u];
      out.light[to] = row.light[u];
      out.shared[to] = row.shared[u];
      out.residual[to] = row.residual[u] + row.rate[u] * row.known_rate[x] + row.light[u] * row.known_light[x];
      out.used[to] = 1;
    }
  }
}

void take_samples(const PhaseMaps& maps, const PolarityMaps& polarity, const BurstErrors& known, float black_dn,
                  float max_residual, MotionSamples& out) {
  const auto width = static_cast<std::size_t>(maps.phase_rad.width());
  place_samples(maps.phase_rad.width(), maps.phase_rad.height(), out);
  ErrorRows rows(known, black_dn, maps.phase_rad.width());
  GatheredRow gathered;
  std::vector<float> row(4 * width);
  float* r = row.data();
  for (int v = 0; v < maps.phase_rad.height(); v += kPixelStep) {
    const GatheredRuns runs = runs_of_row(out, maps.phase_rad.width() / kNode_px, v);
    if (runs.count == 0) continue;
    const RowErrors e = rows.at(polarity, v);
    left_row(gathered.of(maps, e, maps.phase_rad.index(0, v), runs), runs.pixels(),
             {r, r + width, r + 2 * width, r + 3 * width});
    take_sample_row(maps, v, {r, r + width, r + 2 * width, r + 3 * width, e.rate, e.light}, max_residual, out);
  }
}

}  // namespace enamel::algo
