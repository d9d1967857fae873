#include "pipeline/decode/steps/fringe_orders.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>

#include "pipeline/decode/steps/chosen.hpp"

namespace enamel::pipeline {

double FringeOrders::code_agreement() const noexcept {
  const double judged = judged_px();
  return judged > 0 ? orders.agreeing_px / judged : 0;
}

double FringeOrders::torn_share() const noexcept {
  return orders.seams > 0 ? static_cast<double>(orders.torn_seams) / static_cast<double>(orders.seams) : 0;
}

double withdraw_contradicted(FringeOrders& o, double min_agreement) {
  struct Region {
    double agrees_px = 0, contradicts_px = 0;
    std::size_t contradicting = 0;
  };
  const auto& segments = o.segments.segments;
  const auto key = [&](std::size_t k) { return std::pair(segments[k].component, o.orders.segments[k].shift); };
  std::map<std::pair<std::int32_t, std::int32_t>, Region> regions;
  for (std::size_t k = 0; k < segments.size(); ++k) {
    const Stance code = o.orders.segments[k].code;
    if (code == Stance::kSilent) continue;
    Region& region = regions[key(k)];
    const double px = segments[k].end - segments[k].begin;
    (code == Stance::kAgrees ? region.agrees_px : region.contradicts_px) += px;
    region.contradicting += code == Stance::kContradicts ? 1 : 0;
  }
  std::erase_if(regions, [&](const auto& entry) {
    const Region& r = entry.second;
    return r.contradicting < kFewestLiars || r.agrees_px >= min_agreement * (r.agrees_px + r.contradicts_px);
  });
  double decided_px = 0, withdrawn_px = 0;
  for (std::size_t k = 0; k < segments.size(); ++k) {
    if (!o.orders.segments[k].decided) continue;
    const double px = segments[k].end - segments[k].begin;
    decided_px += px;
    if (!regions.contains(key(k))) continue;
    withdrawn_px += px;
    o.orders.segments[k].decided = false;
  }
  return decided_px > 0 ? withdrawn_px / decided_px : 0;
}

void find_spans(FringeOrders& o) {
  const auto& segments = o.segments.segments;
  o.spans.clear();
  for (std::size_t k = 0; k < segments.size(); ++k) {
    const Segment& p = segments[k];
    const SegmentOrder& order = o.orders.segments[k];
    if (!order.decided || order.speck) continue;
    const bool whole = p.joined && k + 1 < segments.size() && segments[k + 1].joined;
    o.spans.push_back({p.row, p.begin, p.end, p.cell + 2 * order.shift, whole});
  }
}

void reject_undecided(const FringeOrders& o, Map<PixelReject>& reject) {
  const auto& segments = o.segments.segments;
  for (std::size_t k = 0; k < segments.size(); ++k) {
    const Segment& p = segments[k];
    const SegmentOrder& order = o.orders.segments[k];
    if (order.decided && !order.speck) continue;
    const PixelReject why = order.decided ? PixelReject::kSpeck : PixelReject::kRelative;
    std::fill(&reject(p.begin, p.row), &reject(p.begin, p.row) + (p.end - p.begin), why);
  }
}

void reject_beside_jumps(const FringeOrders& o, Map<PixelReject>& reject) {
  const auto& segments = o.segments.segments;
  for (std::size_t k = 1; k < segments.size(); ++k) {
    const Segment &before = segments[k - 1], &p = segments[k];
    const SegmentOrder &a = o.orders.segments[k - 1], &b = o.orders.segments[k];
    if (!p.joined || !a.decided || !b.decided || a.shift == b.shift) continue;
    const std::int32_t first = std::max(before.begin, p.begin - kMixed_px), end = std::min(p.end, p.begin + kMixed_px);
    for (std::int32_t u = first; u < end; ++u) {
      if (reject(u, p.row) == PixelReject::kNone) reject(u, p.row) = PixelReject::kEdge;
    }
  }
}

}  // namespace enamel::pipeline
