#include "pipeline/decode/unwrap/order_windows.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <span>

namespace enamel::pipeline {
namespace {

using Part = OrderResult::Work::Part;

void widen(Part& part, const Segment& p) {
  part.low = std::min(part.low, p.low);
  part.last_low = std::max(part.last_low, p.low);
  part.high = std::max(part.high, p.high);
  part.widest = std::max(part.widest, p.high - p.low + 1);
}

bool in_one_window(const Part& part) { return part.high - part.low + 1 + 2 * kBeyond <= kStates; }

/// Of a segment in the windows of its part; those without a place in the depth range go with the nearest that have one.
std::size_t slot_of(const Part& part, const Segment& p) {
  return part.first_slot + static_cast<std::size_t>(std::clamp(p.low, part.low, part.last_low) - part.low);
}

/// px: pixels of the segments whose range begins at each shift from `low` on; used up. base: of the same segments.
void cover(std::span<std::int32_t> px, std::int32_t low, std::size_t width, std::span<std::int32_t> base) {
  width = std::min(width, px.size());
  const auto held = [&](std::size_t first) {
    return std::reduce(px.begin() + static_cast<std::ptrdiff_t>(first),
                       px.begin() + static_cast<std::ptrdiff_t>(first + width));
  };
  for (;;) {
    std::size_t best = 0;
    std::int32_t most = 0;
    for (std::size_t first = 0; first + width <= px.size(); ++first) {
      const std::int32_t here = held(first);
      if (here > most) best = first, most = here;
    }
    if (most == 0) return;
    for (std::size_t k = best; k < best + width; ++k) {
      if (px[k] > 0) base[k] = low + static_cast<std::int32_t>(best) - kBeyond;
      px[k] = 0;
    }
  }
}

Part& part_of(const Segment& p, OrderResult::Work& work) { return work.parts[static_cast<std::size_t>(p.component)]; }

/// Fills window_base for the parts that have slots.
void find_windows(const std::vector<Segment>& segments, OrderResult::Work& work) {
  for (const Segment& p : segments) {
    const Part& part = part_of(p, work);
    if (part.slots > 0) work.window_px[slot_of(part, p)] += p.end - p.begin;
  }
  const std::span px(work.window_px), base(work.window_base);
  for (const Part& part : work.parts) {
    const auto width = static_cast<std::size_t>(std::max(1, kStates - 2 * kBeyond - part.widest + 1));
    cover(px.subspan(part.first_slot, part.slots), part.low, width, base.subspan(part.first_slot, part.slots));
  }
}

}  // namespace

void find_bases(const std::vector<Segment>& segments, std::int32_t components, OrderResult::Work& work) {
  work.parts.assign(static_cast<std::size_t>(components), {});
  for (const Segment& p : segments) {
    if (p.low <= p.high) widen(part_of(p, work), p);
  }
  std::size_t slots = 0;
  for (Part& part : work.parts) {
    if (part.widest == 0) part.low = part.last_low = part.high = kBeyond;  // no segment has a place
    part.first_slot = slots;
    part.slots = in_one_window(part) ? 0 : static_cast<std::size_t>(part.last_low - part.low) + 1;
    slots += part.slots;
  }
  work.window_px.assign(slots, 0);
  work.window_base.assign(slots, 0);
  if (slots > 0) find_windows(segments, work);
  work.base.resize(segments.size());
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const Part& part = part_of(segments[i], work);
    work.base[i] = part.slots > 0 ? work.window_base[slot_of(part, segments[i])] : part.low - kBeyond;
  }
}

}  // namespace enamel::pipeline
