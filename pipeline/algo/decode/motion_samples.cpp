#include "pipeline/algo/decode/motion_samples.hpp"

#include <algorithm>

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

GatheredRuns runs_of_row(const MotionSamples& samples, int width, int v) {
  const int columns = width / kNode_px;
  const auto nodes = nodes_of_row(samples, columns, v / kNode_px);
  if (nodes.empty()) return {};
  const int first = nodes.front() % columns * kNode_px + first_column(v);
  return {static_cast<std::size_t>(first), 2 * kNode_px, nodes.size()};
}

namespace {

/// Memory of a row of `count` pixels.
ClosureRow scratch_row(MotionSamples& samples, std::size_t count) {
  samples.row.resize(6 * count);
  float* r = samples.row.data();
  return {r, r + count, r + 2 * count, r + 3 * count, r + 4 * count, r + 5 * count};
}

/// Puts the sampled pixels of row v where their nodes' are.
void put_row(int width, int v, const ClosureRow& row, bool second_order, MotionSamples& out) {
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

}  // namespace

void take_samples(const PhaseMaps& maps, const PolarityMaps& polarity, float black_dn, float max_residual,
                  MotionSamples& out) {
  const int width = maps.phase_rad.width();
  place_samples(width, maps.phase_rad.height(), out);
  out.pixels.take(maps, polarity, out);
  for (int v = 0; v < maps.phase_rad.height(); v += kPixelStep) {
    const SampledRow pixels = out.pixels.row(v);
    if (pixels.count == 0) continue;
    const ClosureRow row = scratch_row(out, pixels.count);
    closure_row(pixels, black_dn, max_residual, row);
    put_row(width, v, row, true, out);
  }
}

void take_sample_row(int width, int v, const SampleRow& row, float max_residual, MotionSamples& out) {
  const std::size_t count = runs_of_row(out, width, v).pixels();
  const ClosureRow known = scratch_row(out, count);
  known_row(row, count, max_residual, known);
  put_row(width, v, known, false, out);
}

void take_samples(const PhaseMaps& maps, const PolarityMaps& polarity, const BurstErrors& known, float black_dn,
                  float max_residual, MotionSamples& out) {
  const int width = maps.phase_rad.width();
  place_samples(width, maps.phase_rad.height(), out);
  ErrorRows rows(known, black_dn, width);
  GatheredErrors gathered;
  std::vector<float> row(4 * static_cast<std::size_t>(width));
  for (int v = 0; v < maps.phase_rad.height(); v += kPixelStep) {
    const SampledRow p = out.pixels.row(v);
    if (p.count == 0) continue;
    const RowErrors e = gathered.of(rows.at(polarity, v), p.weight, p.runs);
    float* r = row.data();
    const LeftRow left{r, r + p.count, r + 2 * p.count, r + 3 * p.count};
    left_row({p.cosine, p.sine, p.code, p.mean, p.phase, e}, p.count, left);
    take_sample_row(
        width, v, {left.residual, left.by_rate, left.by_light, left.by_harmonic, e.rate, e.light, p.modulation, p.open},
        max_residual, out);
  }
}

}  // namespace enamel::algo
