#include "pipeline/decode/steps/sight.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/decode/steps/sight_cells.hpp"

namespace enamel::pipeline {
namespace {

/// Of the image's cells: light and contrast of fewer tell nothing of the whole. chosen: by judgement.
constexpr double kFewestLit = 0.33;
/// Frames of one surface have the same mean; of their light. chosen: jaws, teeth, balls and planes at 0 to 25 mm/s show
/// up to 0.017, a lamp at 100 Hz that adds a third of the light and swings by a third of itself 0.04 to 0.11.
constexpr double kFlicker = 0.03;
/// A cell that is lit and has no fringes. chosen: teeth and gum keep 0.15 and more of the fringes' contrast.
constexpr double kNoContrast = 0.08;
/// Of the image's cells: so many without fringes are a veil. chosen: by judgement.
constexpr double kVeiledCells = 0.02;
/// Spread of a veil over its mean below which it lies on the window. chosen: a lamp is shaded by form and colour.
constexpr double kEven = 0.1;
/// Of the median light, and the share of the contrast's variation that one veil explains. chosen: plaster shows up to
/// 0.02 of a veil, where light inside or colour vary less than 0.92 is explained.
constexpr double kLeastVeil = 0.12, kExplained = 0.95;
/// Contrast over that of most cells: mirror light keeps all of it where light inside takes most.
/// chosen: teeth and gum have 0.2 to 0.45, metal 0.65 and more.
constexpr double kMirrorContrast = 0.62, kTissueContrast = 0.5;
/// Cells of one crown: 8 mm across are 64 of them. chosen: glints on teeth make up to 20.
constexpr std::size_t kMetalCells = 24;
/// Glare worth a word: of the lit pixels. chosen: dry teeth show up to 0.0006 at a time.
constexpr double kGlareOfLit = 0.002;
/// Of a cell's pixels: so many at full scale are glare. chosen: by judgement.
constexpr double kGlareOfCell = 0.02;

struct Veil {
  double level_dn = 0;
  SightTrouble from = SightTrouble::kNone;
};

/// Light on cells that no fringe reaches.
Veil veil_of_unlit(const SightCells& cells) {
  double count = 0, sum = 0, sum2 = 0;
  for (const SightCell& cell : cells.all) {
    if (!cell.is_lit() || cell.contrast() > kNoContrast) continue;
    const double light = cell.light_dn();
    count += 1, sum += light, sum2 += light * light;
  }
  if (count < kVeiledCells * static_cast<double>(cells.all.size())) return {};
  const double mean = sum / count, variance = std::max(0.0, sum2 / count - mean * mean);
  return {mean, std::sqrt(variance) < kEven * mean ? SightTrouble::kFog : SightTrouble::kLamp};
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
  const bool shows = sab * sab > kExplained * saa * sbb && slope < 1 && level > kLeastVeil * a / n;
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
