#include "pipeline/decode/unwrap/order.hpp"

#include <algorithm>
#include <limits>

#include "pipeline/decode/unwrap/chosen.hpp"
#include "pipeline/decode/unwrap/lit_columns.hpp"
#include "pipeline/decode/unwrap/order_rows.hpp"
#include "pipeline/decode/unwrap/segment_sets.hpp"

namespace enamel::pipeline {
namespace {

class Solver {
 public:
  Solver(const std::vector<Segment>& segments, const CodeEvidence& evidence, const OrderConfig& config,
         OrderResult& out)
      : segments_(segments), evidence_(evidence), config_(config), out_(out), work_(out.work) {}

  void run(std::int32_t components) {
    label_rows(segments_, components, evidence_, config_, out_);
    choose_by_columns(segments_, evidence_.cells(), config_, out_);
    find_open();
    inherit(kBroad_px, std::numeric_limits<std::int32_t>::max());
    stay_within_range();
    inherit(1, config_.min_region_px);
    count_seams();
    find_specks();
  }

 private:
  using Zone = OrderResult::Work::Zone;

  /// layout: in place of a shift.
  static constexpr std::int32_t kUnknown = std::numeric_limits<std::int32_t>::max(), kSeveral = kUnknown - 1;

  /// A zone of undecided segments that borders on decided ones of one shift only continues that surface: plain
  /// unwrapping. Where two shifts meet in it nobody knows the place, and where its own code speaks against, of a
  /// segment's row or of the whole zone, it stays undecided. Neighbours in another row count when they share least_px
  /// columns: less may be a leak through an edge's blur. Only zones of fewer than most_px pixels.
  void inherit(std::int32_t least_px, std::int32_t most_px) {
    if (!find_open_zones(least_px)) return;
    for (Zone& zone : work_.zones) zone.offer = zone.around < kSeveral && zone.px < most_px ? zone.around : kUnknown;
    take_offers();
  }

  /// A zone lies within the depth range where its code leaves most of it one place there and none of the decided
  /// segments beside it lies where the code is the same again: nothing speaks for the repetitions beyond.
  void stay_within_range() {
    if (evidence_.repeats_after() == 0 || !find_open_zones(kBroad_px)) return;
    for (const std::int32_t open : work_.open) {
      const Segment& p = segments_[index(open)];
      const std::int32_t state = only_within_range(index(open));
      if (state >= 0) zone_of(index(open)).votes_px[index(state)] += p.end - p.begin;
    }
    for (Zone& zone : work_.zones) {
      const auto most = std::ranges::max_element(zone.votes_px);
      const auto state = static_cast<std::int32_t>(most - zone.votes_px.begin());
      const bool clear = 2 * *most > zone.px && (zone.beside & repetitions_of(state)) == 0;
      zone.offer = clear ? zone.base + state : kUnknown;
    }
    take_offers();
  }

  /// States at which the code is that of `state`, but for that one itself; a bit each.
  [[nodiscard]] std::uint32_t repetitions_of(std::int32_t state) const {
    const std::int32_t period = evidence_.repeats_after();
    std::uint32_t out = 0;
    for (std::int32_t k = state % period; k < kStates; k += period) out |= k == state ? 0U : 1U << index(k);
    return out;
  }

  /// The cheapest state of a segment if it is clearly so but for repetitions of the code beyond the range; -1: it is
  /// not.
  [[nodiscard]] std::int32_t only_within_range(std::size_t i) const {
    const Segment& p = segments_[i];
    const std::int32_t base = work_.base[i];
    OrderCosts costs;
    mean_of(work_.up[i], work_.down[i]).store(costs);
    for (std::int32_t k = 0; k < kStates; ++k)
      if (repeats_range(p, base + k, evidence_.repeats_after())) costs.of[index(k)] = kImpossible;
    const Choice best = cheapest(CostPair(costs));
    const bool clear = best.least < kImpossible && best.margin >= to_cost(config_.decided_margin);
    const bool within = base + best.state >= p.low && base + best.state <= p.high;
    return clear && within ? best.state : -1;
  }

  /// Gives the open segments the shift that their zone offers, unless their code speaks against it.
  void take_offers() {
    for (const std::int32_t open : work_.open) {
      const std::size_t i = index(open);
      const Zone& zone = zone_of(i);
      if (zone.offer == kUnknown) continue;
      const std::int32_t state = zone.offer - zone.base;
      if (state < 0 || state >= kStates) continue;
      const auto k = static_cast<std::size_t>(state);
      const OrderCosts& total = work_.row[i];  // of its own row, not diluted by others
      if (total.of[k] - least(total) > to_cost(config_.inherit_cost)) continue;
      out_.segments[i].shift = zone.offer;
      (contradicts(zone, k) ? out_.segments[i].disowned : out_.segments[i].inherited) = true;
    }
    for (const std::int32_t i : work_.open) out_.segments[index(i)].decided = out_.segments[index(i)].inherited;
  }

  /// Whether the code of the zone as a whole speaks against a state. Rows are as many witnesses as a running mean over
  /// them takes them for: one in 1/(1 - row_memory).
  [[nodiscard]] bool contradicts(const Zone& zone, std::size_t state) const {
    const std::int64_t more = zone.costs[state] - *std::min_element(zone.costs.begin(), zone.costs.end());
    return (1 - config_.row_memory) * static_cast<float>(more) > static_cast<float>(to_cost(config_.inherit_cost));
  }

  static std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }
  [[nodiscard]] bool undecided(std::size_t i) const { return !out_.segments[i].decided; }
  Zone& zone_of(std::size_t i) { return work_.zones[index(work_.size[i])]; }

  /// Drops what is decided by now from work_.open and finds the zones of what is left; false: nothing is.
  bool find_open_zones(std::int32_t least_px) {
    std::erase_if(work_.open, [&](std::int32_t i) { return !undecided(index(i)); });
    if (work_.open.empty()) return false;
    find_zones(least_px);
    look_around(least_px);
    return true;
  }

  /// Fills work_.open, and work_.links with the pairs of which one or both are undecided.
  void find_open() {
    work_.open.clear();
    work_.links.clear();
    for (std::size_t i = 0; i < segments_.size(); ++i) {
      const bool own = undecided(i);
      if (own) work_.open.push_back(static_cast<std::int32_t>(i));
      each_neighbour(segments_[i], i, [&](std::size_t o) {
        if (!own && !undecided(o)) return;
        const Segment &a = segments_[i], &b = segments_[o];
        const std::int32_t shared = std::min(a.end, b.end) - std::max(a.begin, b.begin);
        work_.links.push_back({static_cast<std::int32_t>(i), static_cast<std::int32_t>(o),
                               a.row == b.row ? std::numeric_limits<std::int32_t>::max() : shared});
      });
    }
  }

  /// Pairs but for those of different rows with fewer than least_px columns in common.
  template <class Visit>
  void each_link(std::int32_t least_px, Visit visit) const {
    for (const auto& link : work_.links) {
      if (link.shared_px >= least_px) visit(index(link.segment), index(link.other));
    }
  }

  /// Fills work_.zones, and work_.size with the zone of each undecided segment.
  void find_zones(std::int32_t least_px) {
    SegmentSets sets(segments_.size(), work_.parent);
    each_link(least_px, [&](std::size_t i, std::size_t o) {
      if (undecided(i) && undecided(o) && work_.base[i] == work_.base[o]) sets.unite(i, o);
    });
    work_.zones.clear();
    work_.size.resize(segments_.size());
    for (const std::int32_t open : work_.open) {
      const std::size_t i = index(open), root = sets.root(i);  // the first of its zone
      if (root == i) work_.zones.push_back({.base = work_.base[i], .around = kUnknown});
      work_.size[i] = root == i ? static_cast<std::int32_t>(work_.zones.size()) - 1 : work_.size[root];
      Zone& zone = zone_of(i);
      zone.px += segments_[i].end - segments_[i].begin;
      for (std::size_t k = 0; k < kOrderStates; ++k) zone.costs[k] += work_.unary[i].of[k];
    }
  }

  /// Fills the zones' `around` and `beside`.
  void look_around(std::int32_t least_px) {
    const auto note = [&](std::size_t open, std::size_t source) {
      Zone& zone = zone_of(open);
      const std::int32_t shift = out_.segments[source].shift, state = shift - zone.base;
      zone.around = zone.around == kUnknown || zone.around == shift ? shift : kSeveral;
      if (state >= 0 && state < kStates) zone.beside |= 1U << index(state);
    };
    each_link(least_px, [&](std::size_t i, std::size_t o) {
      if (undecided(i) && !undecided(o)) note(i, o);
      if (!undecided(i) && undecided(o)) note(o, i);
    });
  }

  /// Noise makes a segment's code jump, too: only what speaks counts.
  void count_seams() {
    out_.seams = out_.torn_seams = 0;
    const auto silent = [&](std::size_t i) {
      return evidence_.stance(i, segments_[i].cell + 2 * out_.segments[i].shift) == Stance::kSilent;
    };
    for (std::size_t i = 0; i < segments_.size(); ++i) {
      if (!segments_[i].joined || segments_[i].kink || silent(i) || silent(i - 1)) continue;
      ++out_.seams;
      out_.torn_seams += out_.segments[i].shift != out_.segments[i - 1].shift ? 1U : 0U;
    }
  }

  void find_specks() {
    SegmentSets sets(segments_.size(), work_.parent);
    for (std::size_t i = 0; i < segments_.size(); ++i) {
      const SegmentOrder own = out_.segments[i];
      if (!own.decided) continue;
      const auto alike = [&](std::size_t o) { return out_.segments[o].decided && out_.segments[o].shift == own.shift; };
      const Segment& p = segments_[i];
      if (p.joined && !p.kink && alike(i - 1)) sets.unite(i, i - 1);
      if (p.up >= 0 && alike(index(p.up))) sets.unite(i, index(p.up));
      // One that has this one for its upper neighbour asks itself.
      if (p.down >= 0 && segments_[index(p.down)].up != static_cast<std::int32_t>(i) && alike(index(p.down)))
        sets.unite(i, index(p.down));
    }
    work_.size.assign(segments_.size(), 0);
    for (std::size_t i = 0; i < segments_.size(); ++i) {
      // The first of a set comes before the others, whose parent it then is.
      const std::size_t root = sets.root(i);
      work_.parent[i] = static_cast<std::int32_t>(root);
      work_.size[root] += segments_[i].end - segments_[i].begin;
    }
    for (std::size_t i = 0; i < segments_.size(); ++i)
      out_.segments[i].speck = out_.segments[i].decided && work_.size[index(work_.parent[i])] < config_.min_region_px;
  }

  const std::vector<Segment>& segments_;
  const CodeEvidence& evidence_;
  const OrderConfig& config_;
  OrderResult& out_;
  OrderResult::Work& work_;
};

}  // namespace

void find_orders(const std::vector<Segment>& segments, std::int32_t components, const CodeEvidence& evidence,
                 const OrderConfig& config, OrderResult& out) {
  Solver(segments, evidence, config, out).run(components);
}

void judge_orders(const std::vector<Segment>& segments, const CodeEvidence& evidence, OrderResult& out) {
  out.agreeing_px = out.contradicting_px = 0;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const Segment& p = segments[i];
    const SegmentOrder& o = out.segments[i];
    const Stance stance = o.decided || o.disowned ? evidence.stance(i, p.cell + 2 * o.shift) : Stance::kSilent;
    out.segments[i].code = stance;
    if (stance == Stance::kAgrees) out.agreeing_px += p.end - p.begin;
    if (stance == Stance::kContradicts) out.contradicting_px += p.end - p.begin;
  }
}

}  // namespace enamel::pipeline
