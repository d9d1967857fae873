#include "pipeline/decode/unwrap/order_rows.hpp"

#include <algorithm>
#include <array>

#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/decode/unwrap/order_gap.hpp"
#include "pipeline/decode/unwrap/order_windows.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/unwrap/order_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "pipeline/decode/unwrap/order_states-inl.h"

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
  }

 private:
  void prepare(std::int32_t components) {
    find_bases(segments_, components, work_);
    for (auto* v : {&work_.unary, &work_.row, &work_.right, &work_.up, &work_.down}) v->resize(segments_.size());
    work_.margin.resize(segments_.size());
    out_.segments.resize(segments_.size());
    // In batches: what was just written one by one cannot be read as a vector without waiting.
    for (std::size_t begin = 0; begin < segments_.size(); begin += kBatch)
      price(begin, std::min(kBatch, segments_.size() - begin));
  }

  static constexpr std::size_t kBatch = 16;  ///< layout: segments asked before they are priced

  /// What the code says about the shifts of segments begin ... begin + count - 1, which the range allows, a little
  /// beyond it, as far as the states reach and within the projector's frame.
  void price(std::size_t begin, std::size_t count) {
    std::array<std::int32_t, kBatch> cells;
    std::array<StateNats, kBatch> nats;
    for (std::size_t k = 0; k < count; ++k) cells[k] = segments_[begin + k].cell + 2 * work_.base[begin + k];
    evidence_.costs_of_states(begin, {cells.data(), count}, nats.data());
    const std::int32_t period = evidence_.repeats_after(), last_cell = evidence_.cells() - 1;
    for (std::size_t k = 0; k < count; ++k) {
      const Segment& p = segments_[begin + k];
      const std::int32_t base = work_.base[begin + k], low = p.low - base, high = p.high - base;
      StateRange range{low, high, std::max(low - kBeyond, first_in_frame(cells[k])),
                       std::min(high + kBeyond, (last_cell - cells[k]) >> 1)};
      if (period != 0 && p.joined) {
        range.repeats_to = std::min(low - 1, high - period);
        range.repeats_from = std::max(high + 1, low + period);
      }
      price_states(nats[k], range, work_.unary[begin + k]);
    }
  }

  /// Of a segment's states: those within the depth range and those asked; up to and from which on the code of one
  /// beyond the range is that of one within.
  struct StateRange {
    std::int32_t low, high, first, last;
    std::int32_t repeats_to = -1, repeats_from = kStates;
  };

  /// Where nothing but the range tells an order beyond it from one within, the range counts once a run: summed over
  /// the segments of a run it would outvote the rows and columns around that follow the surface out of the range.
  void price_states(const StateNats& said, const StateRange& of, OrderCosts& out) const {
    const StateRange r = of;
    const float per_order = config_.beyond_range_cost;
    const float* __restrict nats = said.data();
    std::array<std::int32_t, kOrderStates> priced;
    for (std::int32_t k = 0; k < kStates; ++k) {
      const std::int32_t below = r.low - k, above = k - r.high, off = below > above ? below : above;
      const bool counts = (off > 0) & (k > r.repeats_to) & (k < r.repeats_from);
      const float cost = nats[k] + per_order * static_cast<float>(counts ? off : 0);
      const std::int32_t in_64ths = (static_cast<std::int32_t>(smaller(cost, kImpossibleNats) * 128) + 1) >> 1;
      priced[static_cast<std::size_t>(k)] = ((k >= r.first) & (k <= r.last)) ? in_64ths : kImpossible;
    }
    for (std::size_t k = 0; k < kOrderStates; ++k) out.of[k] = static_cast<Cost>(priced[k]);
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
      passed_on(States::load(said), States::load(work_.unary[to]), unseen_jump_).store(out);
    } else {
      const GapCosts g = before(later);
      pass_gap_here(said, work_.unary[to], from < to ? g : GapCosts{-g.lean, g.below, g.above}, out);
    }
  }

  /// Forward messages of each row, in `row`, and backward ones, in `right`. The two directions take turns: each waits
  /// for its own message before.
  void along_rows() {
    const std::size_t n = segments_.size();
    work_.row[0] = work_.unary[0];
    work_.right[n - 1] = work_.unary[n - 1];
    for (std::size_t i = 1; i < n; ++i) {
      tell(work_.row[i - 1], i - 1, i, work_.row[i]);
      tell(work_.right[n - i], n - i, n - 1 - i, work_.right[n - 1 - i]);
    }
  }

  /// row = the sum of both, the segment's own evidence once, less its least; then running means over the rows above and
  /// below. A mean, not a sum: what misleads the code (an edge, a moving shadow) misleads many rows alike, so that
  /// repeating it makes it no truer.
  void between_rows() {
    const std::size_t n = segments_.size();
    for (std::size_t i = 0; i < n; ++i) {
      const States sum =
          States::each([](auto a, auto b, auto own) HWY_ATTR { return hn::Add(a, hn::Sub(b, own)); },
                       States::load(work_.row[i]), States::load(work_.right[i]), States::load(work_.unary[i]));
      const States row = levelled(sum);
      row.store(work_.row[i]);
      mean_of_rows(work_.up, segments_[i].up, i, row).store(work_.up[i]);
    }
    const Cost margin = to_cost(config_.decided_margin);
    for (std::size_t i = n; i-- > 0;) {
      const States down = mean_of_rows(work_.down, segments_[i].down, i, States::load(work_.row[i]));
      down.store(work_.down[i]);
      choose(i, cheapest_state(mean_of_states(States::load(work_.up[i]), down)), margin);
    }
  }

  [[nodiscard]] HWY_INLINE States mean_of_rows(const std::vector<OrderCosts>& mean, std::int32_t neighbour,
                                               std::size_t i, const States& own) const {
    if (neighbour < 0) return own;
    const auto o = static_cast<std::size_t>(neighbour);
    const std::int32_t offset = work_.base[i] - work_.base[o];
    if (offset == 0) return blended(States::load(mean[o]), own, share_, most_above_);
    return blended(States::load(moved(mean[o], offset, hn::GetLane(most_above_))), own, share_, most_above_);
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

  HWY_INLINE void choose(std::size_t i, const Choice& choice, Cost margin) {
    const bool possible = choice.least < kImpossible;
    SegmentOrder& out = out_.segments[i];
    out = {};
    out.shift = work_.base[i] + choice.state;
    out.decided = possible && choice.margin >= margin;
    work_.margin[i] = possible ? choice.margin : Cost{0};
  }

  const std::vector<Segment>& segments_;
  const CodeEvidence& evidence_;
  const OrderConfig& config_;
  OrderResult& out_;
  OrderResult::Work& work_;
  StateLanes unseen_jump_ = hn::Set(StateTag(), to_cost(config_.unseen_jump_cost));
  StateLanes most_above_ = hn::Set(StateTag(), to_cost(4 * config_.unseen_jump_cost));
  StateLanes share_ = hn::Set(StateTag(), to_share(config_.row_memory));
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
