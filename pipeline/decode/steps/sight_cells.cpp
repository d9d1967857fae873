#include "pipeline/decode/steps/sight_cells.hpp"

#include <algorithm>

namespace enamel::pipeline {
namespace {

constexpr int kRowStep_px = 2;  // layout: every other row tells as much
/// derived: C and S3 each have the variance 2/3 sigma^2 of three frames, and B^2 is the sum of their squares.
constexpr float kNoiseOfFringe2 = 4.0F / 3;

void add_row(const PhaseMaps& maps, const NoiseModel& noise, int v, SightCells& out) {
  const std::size_t at = maps.reject.index(0, v);
  for (int u = 0; u < maps.reject.width(); ++u) {
    const std::size_t i = at + static_cast<std::size_t>(u);
    SightCell& cell = out.all[static_cast<std::size_t>((v / kSightCell_px) * out.columns + u / kSightCell_px)];
    if (maps.reject[i] == PixelReject::kSaturated) {
      ++cell.saturated;
      continue;
    }
    const float c = maps.cosine_dn[i], s = maps.sine_dn[i], light = maps.mean_dn[i] - noise.black_dn;
    ++cell.measured;
    cell.light += static_cast<double>(light);
    cell.fringe2 += static_cast<double>(c * c + s * s);
    cell.noise2 += static_cast<double>(kNoiseOfFringe2 * noise.variance(maps.mean_dn[i]));
    if (maps.reject[i] == PixelReject::kDark) continue;
    ++out.lit_px;
    out.cosine += static_cast<double>(c), out.sine += static_cast<double>(s), out.light += static_cast<double>(light);
  }
}

}  // namespace

SightCells sight_cells(const PhaseMaps& maps, const NoiseModel& noise) {
  SightCells out;
  out.columns = (maps.reject.width() + kSightCell_px - 1) / kSightCell_px;
  out.rows = (maps.reject.height() + kSightCell_px - 1) / kSightCell_px;
  out.all.resize(static_cast<std::size_t>(out.columns * out.rows));
  for (int v = 0; v < maps.reject.height(); v += kRowStep_px) add_row(maps, noise, v, out);
  for (const SightCell& cell : out.all) out.saturated_px += static_cast<std::size_t>(cell.saturated);
  out.lit_px += out.saturated_px;
  return out;
}

CellGroup largest_group(const SightCells& cells, const std::function<bool(const SightCell&)>& belongs) {
  std::vector<bool> open(cells.all.size());
  for (std::size_t k = 0; k < open.size(); ++k) open[k] = belongs(cells.all[k]);
  CellGroup best;
  std::vector<int> reached;
  for (std::size_t start = 0; start < open.size(); ++start) {
    if (!open[start]) continue;
    CellGroup group;
    open[start] = false;
    reached.assign(1, static_cast<int>(start));
    while (!reached.empty()) {
      const int column = reached.back() % cells.columns, row = reached.back() / cells.columns;
      reached.pop_back();
      ++group.cells, group.x_px += (column + 0.5) * kSightCell_px, group.y_px += (row + 0.5) * kSightCell_px;
      for (int y = std::max(0, row - 1); y <= std::min(cells.rows - 1, row + 1); ++y) {
        for (int x = std::max(0, column - 1); x <= std::min(cells.columns - 1, column + 1); ++x) {
          const int k = y * cells.columns + x;
          if (!open[static_cast<std::size_t>(k)]) continue;
          open[static_cast<std::size_t>(k)] = false;
          reached.push_back(k);
        }
      }
    }
    if (group.cells > best.cells) best = group;
  }
  if (best.cells > 0) best.x_px /= static_cast<double>(best.cells), best.y_px /= static_cast<double>(best.cells);
  return best;
}

}  // namespace enamel::pipeline
