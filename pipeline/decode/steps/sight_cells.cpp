#include "pipeline/decode/steps/sight_cells.hpp"

#include <algorithm>
#include <vector>

#include "pipeline/decode/phase/row_memory.hpp"
#include "pipeline/decode/steps/sight_rows.hpp"

namespace enamel::pipeline {
namespace {

constexpr int kRowStep_px = 2;  // layout: every other row tells as much
/// The sums of image columns over a row of cells, brought together.
void add_cells(const RowMemory& sums, std::size_t width, SightCell* cells, SightCells& out) {
  for (std::size_t u = 0; u < width; ++u) {
    const auto of = [&](SightSum k) { return static_cast<double>(sums[k * width + u]); };
    SightCell& cell = cells[u / kSightCell_px];
    cell.measured += static_cast<int>(of(kMeasured)), cell.saturated += static_cast<int>(of(kSaturated));
    cell.light += of(kLight), cell.fringe2 += of(kFringe2), cell.noise2 += of(kNoise2);
    out.lit_px += static_cast<std::size_t>(of(kLit));
    out.cosine += of(kLitCosine), out.sine += of(kLitSine), out.light += of(kLitLight);
  }
}

}  // namespace

SightCells sight_cells(const PhaseMaps& maps, const NoiseModel& noise) {
  SightCells out;
  out.columns = (maps.reject.width() + kSightCell_px - 1) / kSightCell_px;
  out.rows = (maps.reject.height() + kSightCell_px - 1) / kSightCell_px;
  out.all.resize(static_cast<std::size_t>(out.columns * out.rows));
  const auto width = static_cast<std::size_t>(maps.reject.width());
  RowMemory sums(kSightSums * width);
  for (int row = 0; row < out.rows; ++row) {
    std::fill_n(sums.data(), sums.size(), 0.0F);
    const int end = std::min(maps.reject.height(), (row + 1) * kSightCell_px);
    static_assert(kSightCell_px % kRowStep_px == 0);
    for (int v = row * kSightCell_px; v < end; v += kRowStep_px)
      add_sight_row(maps, noise, maps.reject.index(0, v), width, sums.data());
    add_cells(sums, width, &out.all[static_cast<std::size_t>(row * out.columns)], out);
  }
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
