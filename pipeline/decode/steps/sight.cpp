#include "pipeline/decode/steps/sight.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace enamel::pipeline {
namespace {

constexpr int kRowStep_px = 2;  // layout: every other row tells as much
constexpr int kCell_px = 32;    ///< chosen: by judgement, some 0.9 mm of a surface at mid-range
constexpr int kLevels = 256;    // layout: of the veil's histogram
/// Of a cell's pixels: so many at full scale are glare. chosen: by judgement.
constexpr double kGlareOfCell = 0.02;
/// Glare worth a word: of the lit pixels. chosen: dry, glossy teeth show up to 0.0005 at a time.
constexpr double kGlareOfLit = 0.003;
/// Adjoining cells. chosen: a crown is 6 to 10 mm wide; a wet spot shows its lamp in 1 or 2 mm.
constexpr std::size_t kMetalCells = 12;
/// Of the image, and of what shows no fringes: light there is a veil where at least so much has it. chosen: by
/// judgement; shadows of a jaw take up 0.02 and more, and light scattered into them lies at their rims only.
constexpr double kVeiledOfImage = 0.02, kVeiledOfUnlit = 0.5;
/// Of the measured surface's light. chosen: a tenth of false light is a tenth of contrast.
constexpr double kLeastVeil = 0.10;
/// Share of the unlit pixels below the veil's level. chosen: a low quartile leaves out what fringes are too fine on.
constexpr double kVeilQuantile = 0.25;
/// Spread of a veil over its mean, below which it lies on the window. chosen: a lamp is shaded by form and colour.
constexpr double kEven = 0.2;

struct Cell {
  int lit = 0, saturated = 0;
};

/// Counts of the whole image and of its cells.
struct Look {
  int columns = 0, rows = 0;
  std::vector<Cell> cells;
  std::array<int, kLevels> unlit_levels{};  ///< of kNoisy pixels: light above black, over full scale
  std::size_t all = 0, dark = 0, noisy = 0, valid = 0, saturated = 0;
  double valid_dn = 0, noisy_dn = 0, noisy_dn2 = 0;
};

void look_at_row(const PhaseMaps& maps, const NoiseModel& noise, int v, Look& look) {
  const std::size_t at = maps.reject.index(0, v);
  const float to_level = static_cast<float>(kLevels - 1) / (noise.full_scale_dn - noise.black_dn);
  for (int u = 0; u < maps.reject.width(); ++u) {
    const std::size_t i = at + static_cast<std::size_t>(u);
    const float light = maps.mean_dn[i] - noise.black_dn;
    Cell& cell = look.cells[static_cast<std::size_t>((v / kCell_px) * look.columns + u / kCell_px)];
    switch (maps.reject[i]) {
      case PixelReject::kDark:
        ++look.dark;
        break;
      case PixelReject::kSaturated:
        ++look.saturated, ++cell.saturated, ++cell.lit;
        break;
      case PixelReject::kNoisy: {
        ++look.noisy, ++cell.lit;
        look.noisy_dn += static_cast<double>(light), look.noisy_dn2 += static_cast<double>(light * light);
        ++look.unlit_levels[static_cast<std::size_t>(std::clamp(light * to_level, 0.0F, kLevels - 1.0F))];
        break;
      }
      default:
        ++look.valid, ++cell.lit;
        look.valid_dn += static_cast<double>(light);
    }
  }
  look.all += static_cast<std::size_t>(maps.reject.width());
}

Look look_over(const PhaseMaps& maps, const NoiseModel& noise) {
  Look look;
  look.columns = (maps.reject.width() + kCell_px - 1) / kCell_px;
  look.rows = (maps.reject.height() + kCell_px - 1) / kCell_px;
  look.cells.resize(static_cast<std::size_t>(look.columns * look.rows));
  for (int v = 0; v < maps.reject.height(); v += kRowStep_px) look_at_row(maps, noise, v, look);
  return look;
}

/// Light above black of the pixels without fringes, DN; 0 where too few tell.
double veil_of(const Look& look, const NoiseModel& noise) {
  const auto noisy = static_cast<double>(look.noisy);
  if (noisy < kVeiledOfImage * static_cast<double>(look.all)) return 0;
  if (noisy < kVeiledOfUnlit * static_cast<double>(look.noisy + look.dark)) return 0;
  double below = 0;
  for (int level = 0; level < kLevels; ++level) {
    below += look.unlit_levels[static_cast<std::size_t>(level)];
    if (below >= kVeilQuantile * noisy)
      return level * static_cast<double>(noise.full_scale_dn - noise.black_dn) / (kLevels - 1);
  }
  return 0;
}

/// The largest group of adjoining cells that glare: how many, and their pixels' middle.
struct Group {
  std::size_t cells = 0;
  double x = 0, y = 0, weight = 0;
};

bool glares(const Cell& cell) { return cell.saturated > kGlareOfCell * cell.lit && cell.saturated > 0; }

Group group_from(const Look& look, int start, std::vector<bool>& seen) {
  Group group;
  std::vector<int> open{start};
  seen[static_cast<std::size_t>(start)] = true;
  while (!open.empty()) {
    const int at = open.back(), column = at % look.columns, row = at / look.columns;
    open.pop_back();
    const double weight = look.cells[static_cast<std::size_t>(at)].saturated;
    ++group.cells;
    group.x += weight * (column + 0.5) * kCell_px, group.y += weight * (row + 0.5) * kCell_px;
    group.weight += weight;
    for (int y = std::max(0, row - 1); y <= std::min(look.rows - 1, row + 1); ++y) {
      for (int x = std::max(0, column - 1); x <= std::min(look.columns - 1, column + 1); ++x) {
        const auto k = static_cast<std::size_t>(y * look.columns + x);
        if (seen[k] || !glares(look.cells[k])) continue;
        seen[k] = true;
        open.push_back(static_cast<int>(k));
      }
    }
  }
  return group;
}

Group largest_group(const Look& look) {
  Group best;
  std::vector<bool> seen(look.cells.size());
  for (std::size_t k = 0; k < look.cells.size(); ++k) {
    if (seen[k] || !glares(look.cells[k])) continue;
    const Group group = group_from(look, static_cast<int>(k), seen);
    if (group.weight > best.weight) best = group;
  }
  return best;
}

/// Whether the veil is as bright everywhere.
bool is_even(const Look& look) {
  const double n = static_cast<double>(look.noisy), mean = look.noisy_dn / n;
  const double variance = std::max(0.0, look.noisy_dn2 / n - mean * mean);
  return std::sqrt(variance) < kEven * mean;
}

}  // namespace

Sight look_at(const NoiseModel& noise, const PhaseMaps& maps) {
  const Look look = look_over(maps, noise);
  Sight sight;
  const double lit = static_cast<double>(look.valid + look.saturated + look.noisy);
  if (lit == 0) return sight;
  sight.spoilt_share = static_cast<float>(static_cast<double>(look.saturated) / lit);
  const double veil = veil_of(look, noise);
  sight.veil_dn = static_cast<float>(veil);
  if (look.valid > 0 && veil > kLeastVeil * look.valid_dn / static_cast<double>(look.valid)) {
    sight.trouble = is_even(look) ? SightTrouble::kFog : SightTrouble::kLamp;
    return sight;
  }
  if (sight.spoilt_share < kGlareOfLit) return sight;
  const Group group = largest_group(look);
  if (group.cells == 0) return sight;
  sight.trouble = group.cells >= kMetalCells ? SightTrouble::kMetal : SightTrouble::kGlare;
  sight.x_px = static_cast<float>(group.x / group.weight), sight.y_px = static_cast<float>(group.y / group.weight);
  return sight;
}

}  // namespace enamel::pipeline
