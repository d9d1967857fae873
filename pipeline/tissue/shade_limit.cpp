#include "pipeline/tissue/shade_limit.hpp"

namespace enamel::pipeline {
namespace {

/// derived: an even spread over any range, which has no two heaps, comes to 0.75; a bell to 0.64.
constexpr double kParted = 0.75;
/// Octaves between the heaps' middles. chosen: dentine lies half an octave below enamel, gum one and a half.
constexpr double kApart = 0.75;
/// chosen: a burst has a few thousand cells, and one that is half empty shall tell nothing by itself.
constexpr std::uint64_t kFewest = 1000;

}  // namespace

void ShadeLimit::add(const ShadeMap& shade) noexcept {
  for (const std::uint8_t step : shade.pixels()) {
    if (step == kNoShade) continue;
    ++counts_[step];
    ++cells_;
  }
}

/// Otsu 1979: the limit that leaves least variance within the heaps.
ShadeHeaps ShadeLimit::heaps() const noexcept {
  double all = 0, sum = 0, squares = 0;
  for (std::size_t k = 1; k < counts_.size(); ++k) {
    const auto n = static_cast<double>(counts_[k]), at = static_cast<double>(k);
    all += n, sum += n * at, squares += n * at * at;
  }
  ShadeHeaps best;
  if (cells_ < kFewest) return best;
  const double total = squares - sum * sum / all;
  double below = 0, below_sum = 0;
  std::uint8_t limit = kNothingSoft;
  for (std::size_t k = 1; k + 1 < counts_.size(); ++k) {
    below += static_cast<double>(counts_[k]), below_sum += static_cast<double>(counts_[k]) * static_cast<double>(k);
    const double above = all - below;
    if (!(below > 0 && above > 0)) continue;
    const double soft = below_sum / below, hard = (sum - below_sum) / above;
    const double between = below * above / all * (hard - soft) * (hard - soft);
    if (!(between > best.parted * total)) continue;
    best.parted = between / total, best.soft_middle = soft, best.hard_middle = hard;
    limit = static_cast<std::uint8_t>(k + 1);
  }
  const bool two = best.parted > kParted && best.hard_middle - best.soft_middle > kApart * kShadeSteps;
  if (two) best.soft_below = limit;
  return best;
}

}  // namespace enamel::pipeline
