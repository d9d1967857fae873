#include "pipeline/decode/motion/motion_samples.hpp"

#include <algorithm>

#include "pipeline/decode/motion/motion_images.hpp"
#include "pipeline/decode/motion/motion_rows.hpp"

namespace enamel::pipeline {

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

GatheredRuns runs_of_row(const MotionSamples& samples, int width, int v) {
  const int columns = width / kNode_px;
  const auto nodes = nodes_of_row(samples, columns, v / kNode_px);
  if (nodes.empty()) return {};
  const int first = nodes.front() % columns * kNode_px + first_column(v);
  return {static_cast<std::size_t>(first), 2 * kNode_px, nodes.size()};
}

SampledResiduals sampled_residuals(std::size_t count, MotionSamples& out) {
  out.row.resize(6 * count);
  float* r = out.row.data();
  return {r, r + count, r + 2 * count, r + 3 * count, r + 4 * count, r + 5 * count};
}

void put_sampled_residuals(int width, int v, const SampledResiduals& row, bool second_order, MotionSamples& out) {
  const auto nodes = nodes_of_row(out, width / kNode_px, v / kNode_px);
  const auto first = static_cast<std::size_t>(nodes.data() - out.node.data());
  const auto line = static_cast<std::size_t>(v % kNode_px / kPixelStep);
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    for (std::size_t k = 0; k < kGatheredRun; ++k) {
      const std::size_t to = out.place(line * kGatheredRun + k, first + n), from = n * kGatheredRun + k;
      out.rate[to] = row.rate[from], out.light[to] = row.light[from], out.shared[to] = row.shared[from];
      out.residual[to] = row.residual[from], out.used[to] = row.used[from];
      if (second_order) out.rate_per_rate[to] = row.rate_per_rate[from];
    }
  }
}

void take_sample_row(int width, int v, const SampleRow& row, float max_residual, MotionSamples& out) {
  const std::size_t count = runs_of_row(out, width, v).pixels();
  const SampledResiduals known = sampled_residuals(count, out);
  known_row(row, count, max_residual, known);
  put_sampled_residuals(width, v, known, false, out);
}

}  // namespace enamel::pipeline
