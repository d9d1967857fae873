#include "pipeline/decode/mode_m/likely_wraps.hpp"

#include <algorithm>
#include <limits>
#include <tuple>

#include "pipeline/decode/mode_m/micro_phase.hpp"
#include "pipeline/decode/phase/cell_span.hpp"

namespace enamel::pipeline {
namespace {

constexpr std::int32_t kNobodyDecided = std::numeric_limits<std::int32_t>::min();

/// Of equally common shifts the least.
void find_most_common(std::span<const Segment> segments, std::span<const SegmentOrder> orders, std::int32_t components,
                      LikelyWraps& out) {
  auto& votes = out.votes;
  votes.clear();
  for (std::size_t k = 0; k < segments.size(); ++k) {
    if (orders[k].decided)
      votes.push_back({segments[k].component, orders[k].shift, segments[k].end - segments[k].begin});
  }
  std::sort(votes.begin(), votes.end(), [](const auto& a, const auto& b) {
    return std::tie(a.component, a.shift) < std::tie(b.component, b.shift);
  });
  out.most_common.assign(static_cast<std::size_t>(components), kNobodyDecided);
  std::int32_t component = -1, most = 0;
  for (auto same = votes.begin(); same != votes.end();) {
    const auto [c, shift, own] = *same;
    if (c != component) component = c, most = 0;
    std::int32_t pixels = 0;
    for (; same != votes.end() && same->component == c && same->shift == shift; ++same) pixels += same->pixels;
    if (pixels <= most) continue;
    most = pixels;
    out.most_common[static_cast<std::size_t>(c)] = shift;
  }
}

}  // namespace

void find_likely_wraps(std::span<const Segment> segments, std::span<const SegmentOrder> orders, std::int32_t components,
                       int width, int height, LikelyWraps& out) {
  find_most_common(segments, orders, components, out);
  if (out.wraps.width() != width || out.wraps.height() != height) out.wraps = Map<std::int16_t>(width, height);
  std::fill(out.wraps.pixels().begin(), out.wraps.pixels().end(), kNoWraps);
  for (std::size_t k = 0; k < segments.size(); ++k) {
    const Segment& p = segments[k];
    const std::int32_t common = out.most_common[static_cast<std::size_t>(p.component)];
    const std::int32_t shift = orders[k].decided || common == kNobodyDecided ? orders[k].shift : common;
    const auto first = out.wraps.pixels().begin() + static_cast<std::ptrdiff_t>(out.wraps.index(p.begin, p.row));
    std::fill(first, first + (p.end - p.begin), static_cast<std::int16_t>(wraps_of_cell(p.cell + 2 * shift)));
  }
}

}  // namespace enamel::pipeline
