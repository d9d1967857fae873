#include "pipeline/decode/unwrap/order_rows.hpp"

#include <algorithm>
#include <array>

#include "pipeline/decode/unwrap/order_windows.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/unwrap/order_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

class Rows {
 public:
  Rows(const std::vector<Segment>& segments, const CodeEvidence& evidence, const OrderConfig& config, OrderResult& out)
      : segments_(segments), evidence_(evidence), config_(config), out_(out), work_(out.work) {}

  void run(std::int32_t components) {
    prepare(components);
    if (segments_.empty()) return;
    along_rows();
    between_rows();
    choose();
  }

 private:
  void prepare(std::int32_t components) {
    find_bases(segments_, components, work_);
    for (auto* v : {&work_.unary, &work_.row, &work_.right, &work_.up, &work_.down}) v->resize(segments_.size());
    work_.margin.resize(segments_.size());
    out_.segments.assign(segments_.size(), {});
    // In batches: what was just written one by one cannot be read as a vector without waiting.
    std::array<Asked, kBatch> asked;
    for (std::size_t begin = 0; begin < segments_.size(); begin += kBatch) {
      const std::size_t end = std::min(begin + kBatch, segments_.size());
      for (std::size_t i = begin; i < end; ++i) ask(i, asked[i - begin]);
      for (std::size_t i = begin; i < end; ++i) price(i, asked[i - begin]);
    }
  }

  static constexpr std::size_t kBatch = 16;  ///< layout: segments asked before they are priced

  /// What the code says about a segment's shifts first ... last; state 0 is shift `base`.
  struct Asked {
    std::int32_t base, first, last;
    std::array<float, kOrderStates> nats;
  };

  /// The code's evidence for the shifts that the range allows, a little beyond it, as far as the states reach and
  /// within the projector's frame.
  void ask(std::size_t i, Asked& out) const {
    const Segment& p = segments_[i];
    const std::int32_t base = work_.base[i];
    out.base = base;
    out.first = std::max({base, p.low - kBeyond, first_in_frame(p.cell)});
    out.last = std::min({base + kStates - 1, p.high + kBeyond, (evidence_.cells() - 1 - p.cell) >> 1});
    out.nats = {};
    if (out.first > out.last) return;
    evidence_.costs(i, p.cell + 2 * out.first,
                    {out.nats.data() + (out.first - base), static_cast<std::size_t>(out.last - out.first + 1)});
  }

  /// Where nothing but the range tells an order beyond it from one within, the range counts once a run: summed over
  /// the segments of a run it would outvote the rows and columns around that follow the surface out of the range.
  void price(std::size_t i, const Asked& asked) {
    const std::int32_t low = segments_[i].low, high = segments_[i].high;
    const std::int32_t base = asked.base, first = asked.first, last = asked.last;
    const float per_order = config_.beyond_range_cost;
    const std::int32_t period = segments_[i].joined ? evidence_.repeats_after() : 0;
    const std::array<float, kOrderStates> nats = asked.nats;
    OrderCosts unary;
    for (std::int32_t k = 0; k < kStates; ++k) {
      const std::int32_t shift = base + k;
      const std::int32_t beyond =
          repeats_range(segments_[i], shift, period) ? 0 : std::max({low - shift, shift - high, 0});
      const float cost = nats[static_cast<std::size_t>(k)] + per_order * static_cast<float>(beyond);
      const Cost priced = to_cost(std::min(cost, kImpossibleNats));
      unary.of[static_cast<std::size_t>(k)] = ((shift >= first) & (shift <= last)) ? priced : kImpossible;
    }
    work_.unary[i] = unary;
  }

  /// Least shift that brings the cell to 0 or more.
  static std::int32_t first_in_frame(std::int32_t cell) { return -(cell >> 1); }

  Cost jump_cost(const Segment& p) const { return to_cost(p.kink ? config_.kink_jump_cost : config_.shade_jump_cost); }

  /// GapCosts.lean of equal shifts: by how many states the segment before i in the list counts from further up.
  std::int32_t lean_of_bases(std::size_t i) const { return work_.base[i - 1] - work_.base[i]; }

  /// What segment i thinks of the shifts of the segment before it in the row, beyond a gap.
  GapCosts gap_before(std::size_t i) const {
    const Gap& gap = segments_[i].gap;
    const Cost skip = to_cost(gap.contact ? config_.missed_contact_cost : 0);
    const Cost fold = to_cost(config_.fold_cost + (gap.contact ? config_.missed_contact_cost : 0));
    const std::int32_t lean = gap.lean + lean_of_bases(i);
    return gap.rise > 0 ? GapCosts{lean, skip, fold} : GapCosts{lean, fold, skip};
  }

  /// What segment i thinks of the shifts of the segment before it in its run, across a step: a jump that keeps the
  /// projector's columns in order may hide there; the other way something thin would have to stand before the surface.
  GapCosts step_before(std::size_t i) const {
    const Cost jump = jump_cost(segments_[i]), fold = static_cast<Cost>(jump + to_cost(config_.fold_cost));
    const std::int32_t lean = lean_of_bases(i);
    return segments_[i].gap.rise > 0 ? GapCosts{lean, jump, fold} : GapCosts{lean, fold, jump};
  }

  /// What segment i thinks of the shifts of the segment before it in the list; without a gap or a step a jump hides as
  /// likely one way as the other.
  GapCosts before(std::size_t i) const {
    if (!segments_[i].joined) return gap_before(i);
    if (segments_[i].gap.rise != 0) return step_before(i);
    const Cost jump = to_cost(config_.unseen_jump_cost);
    return {lean_of_bases(i), jump, jump};
  }

  /// Message of segment `from` to its neighbour in the row, `to`, with that one's own evidence added.
  void tell(const OrderCosts& said, std::size_t from, std::size_t to, OrderCosts& out) const {
    const std::size_t later = std::max(from, to);
    const Segment& segment = segments_[later];
    if (!segment.joined && segment.gap.rise == 0) {
      out = work_.unary[to];
    } else if (segment.gap.rise == 0 && lean_of_bases(later) == 0) {  // as pass_gap would, but faster
      pass_joined(said, work_.unary[to], to_cost(config_.unseen_jump_cost), out);
    } else {
      const GapCosts g = before(later);
      pass_gap(said, work_.unary[to], from < to ? g : GapCosts{-g.lean, g.below, g.above}, out);
    }
  }

  /// Forward messages of each row, in `row`, and backward ones; then row = their sum, the segment's own evidence once,
  /// less its least.
  /// The two directions take turns: each waits for its own message before.
  void along_rows() {
    const std::size_t n = segments_.size();
    work_.row[0] = work_.unary[0];
    work_.right[n - 1] = work_.unary[n - 1];
    for (std::size_t i = 1; i < n; ++i) {
      tell(work_.row[i - 1], i - 1, i, work_.row[i]);
      tell(work_.right[n - i], n - i, n - 1 - i, work_.right[n - 1 - i]);
    }
    for (std::size_t i = 0; i < n; ++i) {
      const CostPair right(work_.right[i]), unary(work_.unary[i]);
      CostPair row(work_.row[i]);
      row.low += right.low - unary.low;
      row.high += right.high - unary.high;
      level(row, work_.row[i]);
    }
  }

  /// Running means over the rows above and below. A mean, not a sum: what misleads the code (an edge, a moving shadow)
  /// misleads many rows alike, so that repeating it makes it no truer.
  void between_rows() {
    const std::size_t n = segments_.size();
    for (std::size_t i = 0; i < n; ++i) mean_of_rows(work_.up, segments_[i].up, i);
    for (std::size_t i = n; i-- > 0;) mean_of_rows(work_.down, segments_[i].down, i);
  }

  void mean_of_rows(std::vector<OrderCosts>& mean, std::int32_t neighbour, std::size_t i) {
    const OrderCosts& own = work_.row[i];
    if (neighbour < 0) {
      mean[i] = own;
      return;
    }
    const auto o = static_cast<std::size_t>(neighbour);
    const Cost most = to_cost(4 * config_.unseen_jump_cost);
    const std::int32_t offset = work_.base[i] - work_.base[o];
    if (offset == 0) {
      blend(mean[o], own, config_.row_memory, most, mean[i]);
    } else {
      blend(moved(mean[o], offset, most), own, config_.row_memory, most, mean[i]);
    }
  }

  /// Costs by the states of a segment whose base is higher by `offset`; of those that the other segment lacks, `most`
  /// above its least.
  static OrderCosts moved(const OrderCosts& costs, std::int32_t offset, Cost most) {
    const auto dear = static_cast<Cost>(least(costs) + most);
    OrderCosts out;
    for (std::int32_t k = 0; k < kStates; ++k) {
      const std::int32_t from = k + offset;
      const bool known = from >= 0 && from < kStates;
      out.of[static_cast<std::size_t>(k)] = known ? std::min(costs.of[static_cast<std::size_t>(from)], dear) : dear;
    }
    return out;
  }

  void choose() {
    const Cost margin = to_cost(config_.decided_margin);
    for (std::size_t i = 0; i < segments_.size(); ++i) {
      const Choice choice = cheapest(mean_of(work_.up[i], work_.down[i]));
      const bool possible = choice.least < kImpossible;
      out_.segments[i].shift = work_.base[i] + choice.state;
      out_.segments[i].decided = possible && choice.margin >= margin;
      work_.margin[i] = possible ? choice.margin : Cost{0};
    }
  }

  const std::vector<Segment>& segments_;
  const CodeEvidence& evidence_;
  const OrderConfig& config_;
  OrderResult& out_;
  OrderResult::Work& work_;
};

void label(const std::vector<Segment>& segments, std::int32_t components, const CodeEvidence& evidence,
           const OrderConfig& config, OrderResult& out) {
  Rows(segments, evidence, config, out).run(components);
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(label);

void label_rows(const std::vector<Segment>& segments, std::int32_t components, const CodeEvidence& evidence,
                const OrderConfig& config, OrderResult& out) {
  HWY_DYNAMIC_DISPATCH(label)(segments, components, evidence, config, out);
}

}  // namespace enamel::pipeline
#endif
