#include "pipeline/algo/decode/relative_regions.hpp"

#include <algorithm>
#include <numeric>

namespace enamel::algo {
namespace {

/// Sets of pieces; the first of a set in the list is its root.
class Sets {
 public:
  Sets(std::size_t count, std::vector<std::int32_t>& parent) : parent_(parent) {
    parent_.resize(count);
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  std::size_t root(std::size_t i) {
    while (static_cast<std::size_t>(parent_[i]) != i) {
      parent_[i] = parent_[static_cast<std::size_t>(parent_[i])];
      i = static_cast<std::size_t>(parent_[i]);
    }
    return i;
  }
  void unite(std::size_t a, std::size_t b) {
    a = root(a), b = root(b);
    parent_[std::max(a, b)] = static_cast<std::int32_t>(std::min(a, b));
  }

 private:
  std::vector<std::int32_t>& parent_;
};

}  // namespace

void find_relative(std::span<const Piece> pieces, std::span<const PieceOrder> orders, int min_region_px,
                   std::vector<std::int32_t>& parent, RelativeSurface& out) {
  out.clear();
  const auto open = [&](std::size_t i) { return !orders[i].decided; };
  Sets sets(pieces.size(), parent);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (!open(i)) continue;
    const Piece& p = pieces[i];
    if (p.joined && !p.kink && open(i - 1)) sets.unite(i, i - 1);
    for (const std::int32_t other : {p.up, p.down}) {
      if (other >= 0 && open(static_cast<std::size_t>(other))) sets.unite(i, static_cast<std::size_t>(other));
    }
  }
  std::vector<RelativeSurface::Region> found(pieces.size());
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (!open(i)) continue;
    const Piece& p = pieces[i];
    auto& region = found[sets.root(i)];
    const bool first = region.pixels == 0;
    region.low = first ? p.low : std::min(region.low, p.low);
    region.high = first ? p.high : std::max(region.high, p.high);
    region.pixels += p.end - p.begin;
  }
  std::vector<std::int32_t> number(pieces.size(), -1);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (!open(i)) continue;
    const std::size_t root = sets.root(i);
    if (found[root].pixels < min_region_px || found[root].high < found[root].low) continue;
    if (number[root] < 0) {
      number[root] = static_cast<std::int32_t>(out.regions.size());
      out.regions.push_back(found[root]);
    }
    const Piece& p = pieces[i];
    out.spans.push_back({p.row, p.begin, p.end, number[root], turn_of_cell(p.cell)});
  }
}

void cells_of(const RelativeSurface& relative, std::vector<CellSpan>& out) {
  out.clear();
  for (const auto& s : relative.spans) out.push_back({s.row, s.begin, s.end, 2 * s.turn, false});
}

void take_phase(const PhaseMaps& maps, const PhaseRipple& ripple, RelativeSurface& out) {
  for (const auto& s : out.spans) {
    const auto from = static_cast<std::ptrdiff_t>(maps.phase_rad.index(s.begin, s.row));
    const std::ptrdiff_t count = s.end - s.begin;
    const auto phase = maps.phase_rad.pixels().begin() + from, sigma = maps.sigma_rad.pixels().begin() + from;
    out.phase_rad.insert(out.phase_rad.end(), phase, phase + count);
    out.sigma_rad.insert(out.sigma_rad.end(), sigma, sigma + count);
  }
  if (!out.phase_rad.empty()) correct_phase(ripple, out.phase_rad);
}

}  // namespace enamel::algo
