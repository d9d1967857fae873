#include "pipeline/decode/steps/relative_regions.hpp"

#include <algorithm>

#include "pipeline/decode/unwrap/segment_sets.hpp"

namespace enamel::pipeline {

void find_relative(std::span<const Segment> segments, std::span<const SegmentOrder> orders, int min_region_px,
                   std::vector<std::int32_t>& parent, RelativeSurface& out) {
  out.clear();
  const auto open = [&](std::size_t i) { return !orders[i].decided; };
  SegmentSets sets(segments.size(), parent);
  for (std::size_t i = 0; i < segments.size(); ++i) {
    if (!open(i)) continue;
    each_neighbour(segments[i], i, [&](std::size_t o) {
      if (open(o)) sets.unite(i, o);
    });
  }
  std::vector<RelativeSurface::Region> found(segments.size());
  for (std::size_t i = 0; i < segments.size(); ++i) {
    if (!open(i)) continue;
    const Segment& p = segments[i];
    auto& region = found[sets.root(i)];
    const bool first = region.pixels == 0;
    region.low = first ? p.low : std::min(region.low, p.low);
    region.high = first ? p.high : std::max(region.high, p.high);
    region.pixels += p.end - p.begin;
  }
  std::vector<std::int32_t> number(segments.size(), -1);
  for (std::size_t i = 0; i < segments.size(); ++i) {
    if (!open(i)) continue;
    const std::size_t root = sets.root(i);
    if (found[root].pixels < min_region_px || found[root].high < found[root].low) continue;
    if (number[root] < 0) {
      number[root] = static_cast<std::int32_t>(out.regions.size());
      out.regions.push_back(found[root]);
    }
    const Segment& p = segments[i];
    out.spans.push_back({p.row, p.begin, p.end, number[root], wraps_of_cell(p.cell)});
  }
}

void cells_of(const RelativeSurface& relative, std::vector<CellSpan>& out) {
  out.clear();
  for (const auto& s : relative.spans) out.push_back({s.row, s.begin, s.end, 2 * s.wraps, false});
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

}  // namespace enamel::pipeline
