#include "pipeline/decode/unwrap/lit_columns.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/decode/unwrap/chosen.hpp"

namespace enamel::pipeline {
namespace {

/// layout: columns are told apart by eighths of a fringe.
constexpr std::int32_t kPerCell = 4, kPerFringe = 2 * kPerCell;

/// Eighths first … last, none if last < first; of the flood's Phi, or of the projector's with shift * kPerFringe added.
struct Eighths {
  std::int32_t first, last;
  [[nodiscard]] bool empty() const { return last < first; }
};

/// Those whose middle a segment covers, its ends left out.
Eighths covered_by(const Segment& p) {
  constexpr float kPerRad = static_cast<float>(kPerCell) / kPiF;
  const float low = (smaller(p.first_rad, p.last_rad) + kLitEnds_rad) * kPerRad - 0.5F,
              high = (larger(p.first_rad, p.last_rad) - kLitEnds_rad) * kPerRad - 0.5F;
  return {-floor_of(-low), floor_of(high)};
}

class Row {
 public:
  Row(const std::vector<Segment>& segments, const OrderConfig& config, OrderResult& out)
      : segments_(segments),
        out_(out),
        work_(out.work),
        most_(to_cost(config.lit_twice_cost)),
        least_(to_cost(config.least_claim)),
        margin_(to_cost(config.decided_margin)) {}

  /// Segments first … end-1 are a row's.
  void choose(std::size_t first, std::size_t end) {
    std::fill(work_.lit.begin(), work_.lit.end(), LitColumn{});
    for (std::size_t i = first; i < end; ++i) light(i);
    for (std::size_t i = first; i < end; ++i) {
      if (!out_.segments[i].decided) choose(i);
    }
  }

 private:
  /// The part of them that lies on the projector at a shift.
  [[nodiscard]] Eighths at_shift(Eighths e, std::int32_t shift) const {
    const auto columns = static_cast<std::int32_t>(work_.lit.size());
    return {std::max(0, e.first + kPerFringe * shift), std::min(columns - 1, e.last + kPerFringe * shift)};
  }

  void light(std::size_t i) {
    const Cost sure = std::min(work_.margin[i], most_);
    if (sure < least_) return;
    const Eighths e = at_shift(covered_by(segments_[i]), out_.segments[i].shift);
    for (std::int32_t k = e.first; k <= e.last; ++k) {
      LitColumn& lit = work_.lit[static_cast<std::size_t>(k)];
      if (sure > lit.most) {
        lit = {sure, lit.most, static_cast<std::int32_t>(i)};
      } else {
        lit.next = std::max(lit.next, sure);
      }
    }
  }

  /// Mean over a segment's columns of how sure another segment is of them.
  [[nodiscard]] Cost taken(std::size_t i, Eighths covered, std::int32_t shift) const {
    const Eighths e = at_shift(covered, shift);
    std::int32_t sum = 0;
    for (std::int32_t k = e.first; k <= e.last; ++k) {
      const LitColumn& lit = work_.lit[static_cast<std::size_t>(k)];
      sum += lit.segment == static_cast<std::int32_t>(i) ? lit.next : lit.most;
    }
    return static_cast<Cost>(sum / (covered.last - covered.first + 1));
  }

  void choose(std::size_t i) {
    const Eighths covered = covered_by(segments_[i]);
    if (covered.empty()) return;
    const std::int32_t base = work_.base[i];
    const CostPair mean = mean_of(work_.up[i], work_.down[i]);
    const Cost least = least_everywhere(mean)[0],
               too_dear = std::min(kImpossible, static_cast<Cost>(least + most_ + margin_));
    OrderCosts costs;
    mean.store(costs);
    for (std::size_t k = 0; k < kOrderStates; ++k) {
      if (costs.of[k] >= too_dear) continue;
      const Cost more = taken(i, covered, base + static_cast<std::int32_t>(k));
      costs.of[k] = static_cast<Cost>(std::min(costs.of[k] + more, kImpossible - 1));
    }
    const Choice choice = cheapest(CostPair(costs));
    out_.segments[i].shift = base + choice.state;
    out_.segments[i].decided = choice.least < kImpossible && choice.margin >= margin_;
  }

  const std::vector<Segment>& segments_;
  OrderResult& out_;
  OrderResult::Work& work_;
  Cost most_, least_, margin_;
};

}  // namespace

void choose_by_columns(const std::vector<Segment>& segments, int cells, const OrderConfig& config, OrderResult& out) {
  out.work.lit.resize(static_cast<std::size_t>(cells) * kPerCell);
  Row row(segments, config, out);
  for (std::size_t first = 0, end = 0; first < segments.size(); first = end) {
    bool open = false;
    for (end = first; end < segments.size() && segments[end].row == segments[first].row; ++end)
      open |= !out.segments[end].decided && !covered_by(segments[end]).empty();
    if (open) row.choose(first, end);
  }
}

}  // namespace enamel::pipeline
