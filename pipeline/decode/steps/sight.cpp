#include "pipeline/decode/steps/sight.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/decode/steps/chosen.hpp"
#include "pipeline/decode/steps/sight_cells.hpp"

namespace enamel::pipeline {
namespace {

struct Veil {
  double level_dn = 0;
  SightTrouble from = SightTrouble::kNone;
};

/// Light on cells that no fringe reaches.
Veil veil_of_unlit(const SightCells& cells) {
  double count = 0, sum = 0, sum2 = 0;
  for (const SightCell& cell : cells.all) {
    if (!cell.is_lit() || cell.contrast() > kUnlitContrast) continue;
    const double light = cell.light_dn();
    count += 1, sum += light, sum2 += light * light;
  }
  if (count < kVeiledCells * static_cast<double>(cells.all.size())) return {};
  const double mean = sum / count, variance = std::max(0.0, sum2 / count - mean * mean);
  return {mean, std::sqrt(variance) < kEvenVeil * mean ? SightTrouble::kFog : SightTrouble::kLamp};
}

/// A veil that lies over everything alike: B = c (A - veil) over the cells, whatever colour and slope they have.
Veil veil_of_contrast(const SightCells& cells) {
  double n = 0, a = 0, b = 0, aa = 0, ab = 0, bb = 0;
  for (const SightCell& cell : cells.all) {
    if (!cell.is_lit()) continue;
    const double light = cell.light_dn(), fringe = cell.fringe_dn();
    n += 1, a += light, b += fringe, aa += light * light, ab += light * fringe, bb += fringe * fringe;
  }
  const double saa = aa - a * a / n, sab = ab - a * b / n, sbb = bb - b * b / n;
  if (!(n > 2 && saa > 0 && sbb > 0 && sab > 0)) return {};
  const double slope = sab / saa, level = a / n - b / n / slope;
  const bool shows = sab * sab > kVeilExplained * saa * sbb && slope < 1 && level > kLeastVeil * a / n;
  return shows ? Veil{level, SightTrouble::kFog} : Veil{};
}

double lit_share(const SightCells& cells) {
  return static_cast<double>(std::ranges::count_if(cells.all, &SightCell::is_lit)) /
         static_cast<double>(cells.all.size());
}

double median_contrast(const SightCells& cells) {
  std::vector<double> all;
  for (const SightCell& cell : cells.all) {
    if (cell.is_lit()) all.push_back(cell.contrast());
  }
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end());
  return *middle;
}

void put(SightTrouble trouble, const CellGroup& group, Sight& sight) {
  sight.trouble = trouble;
  sight.x_px = static_cast<float>(group.x_px), sight.y_px = static_cast<float>(group.y_px);
}

/// Metal by its mirror light among tissue, glare by what is at full scale.
void find_place(const SightCells& cells, Sight& sight) {
  if (median_contrast(cells) < kTissueContrast) {
    const CellGroup metal =
        largest_group(cells, [](const SightCell& cell) { return cell.is_lit() && cell.contrast() > kMirrorContrast; });
    if (metal.cells >= kMetalCells) return put(SightTrouble::kMetal, metal, sight);
  }
  if (static_cast<double>(sight.spoilt_share) < kGlareOfLit) return;
  const CellGroup glare = largest_group(
      cells, [](const SightCell& cell) { return cell.saturated > kGlareOfCell * (cell.measured + cell.saturated); });
  if (glare.cells > 0) put(SightTrouble::kGlare, glare, sight);
}

}  // namespace

Sight look_at(const NoiseModel& noise, const PhaseMaps& maps) {
  const SightCells cells = sight_cells(maps, noise);
  Sight sight;
  if (cells.lit_px == 0) return sight;
  sight.spoilt_share = static_cast<float>(static_cast<double>(cells.saturated_px) / static_cast<double>(cells.lit_px));
  if (lit_share(cells) < kFewestLit) return sight;
  const Veil unlit = veil_of_unlit(cells), spread = veil_of_contrast(cells);
  const Veil& veil = unlit.from != SightTrouble::kNone ? unlit : spread;
  sight.veil_dn = static_cast<float>(veil.level_dn);
  sight.trouble = cells.unevenness() > kFlicker ? SightTrouble::kLamp : veil.from;
  if (sight.trouble == SightTrouble::kNone) find_place(cells, sight);
  return sight;
}

}  // namespace enamel::pipeline
