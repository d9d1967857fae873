#include "pipeline/algo/decode/motion_samples.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/algo/decode/motion_images.hpp"
#include "pipeline/algo/decode/motion_rows.hpp"
#include "pipeline/algo/phase/closure_rows.hpp"

namespace enamel::algo {

static_assert(kPixelStep == static_cast<int>(kSparseStep));

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

void take_samples(const PhaseMaps& maps, const PolarityMaps& polarity, float black_dn, float max_residual,
                  MotionSamples& out) {
  constexpr std::size_t kPerRow = kNode_px / kPixelStep;  // pixels of a node in one row
  place_samples(maps.phase_rad.width(), maps.phase_rad.height(), out);
  const auto columns = static_cast<std::size_t>(maps.phase_rad.width() / kNode_px);
  std::vector<float> rows(6 * columns * kPerRow);
  float* r = rows.data();
  const std::size_t count = columns * kPerRow;
  const ClosureRow row{r, r + count, r + 2 * count, r + 3 * count, r + 4 * count, r + 5 * count};
  for (std::size_t first = 0, end = 0; first < out.node.size(); first = end) {
    const std::size_t node_row = static_cast<std::size_t>(out.node[first]) / columns;
    while (end < out.node.size() && static_cast<std::size_t>(out.node[end]) / columns == node_row) ++end;
    for (std::size_t line = 0; line < kPerRow; ++line) {
      const int v = static_cast<int>(node_row) * kNode_px + static_cast<int>(line) * kPixelStep;
      const std::size_t at = maps.phase_rad.index(first_column(v), v);
      closure_row(maps, &polarity.weight[at], black_dn, max_residual, at, count, row);
      for (std::size_t n = first; n < end; ++n) {
        const std::size_t from = static_cast<std::size_t>(out.node[n]) % columns * kPerRow;
        for (std::size_t k = 0; k < kPerRow; ++k) {
          const std::size_t to = out.place(line * kPerRow + k, n);
          out.rate[to] = row.rate[from + k], out.rate_per_rate[to] = row.rate_per_rate[from + k];
          out.light[to] = row.light[from + k], out.shared[to] = row.shared[from + k];
          out.residual[to] = row.residual[from + k], out.used[to] = row.used[from + k];
        }
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
      const auto u = row.gathered ? asked : static_cast<std::size_t>((column - row.first) / row.step);
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
  SparseRow sparse;
  std::vector<float> row(4 * width);
  float* r = row.data();
  for (int v = 0; v < maps.phase_rad.height(); v += kPixelStep) {
    const RowErrors e = rows.at(polarity, v);
    const int first = first_column(v);
    const std::size_t count = (width - static_cast<std::size_t>(first) + 1) / kSparseStep;
    left_row(sparse.of(maps, e, maps.phase_rad.index(0, v), static_cast<std::size_t>(first), count), count,
             {r, r + width, r + 2 * width, r + 3 * width});
    take_sample_row(maps, v,
                    {r, r + width, r + 2 * width, r + 3 * width, e.rate, e.light, first, static_cast<int>(kSparseStep)},
                    max_residual, out);
  }
}

}  // namespace enamel::algo
