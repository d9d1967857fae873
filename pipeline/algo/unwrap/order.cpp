#include "pipeline/algo/unwrap/order.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

namespace enamel::algo {
namespace {

constexpr std::int32_t kBeyond = 2;  ///< orders beyond the depth range that a surface is followed
constexpr float kImpossible_nats = 60;
constexpr Cost kImpossible = to_cost(kImpossible_nats);
constexpr auto kStates = static_cast<std::int32_t>(kOrderStates);

class Solver {
 public:
  Solver(const std::vector<Piece>& pieces, const CodeEvidence& evidence, const OrderConfig& config, OrderResult& out)
      : pieces_(pieces), evidence_(evidence), config_(config), out_(out), work_(out.work) {}

  void run(std::int32_t components) {
    prepare(components);
    along_rows();
    between_rows();
    choose();
    inherit();
    count_seams();
    find_specks();
  }

 private:
  void prepare(std::int32_t components) {
    work_.base.assign(static_cast<std::size_t>(components), std::numeric_limits<std::int32_t>::max());
    for (const Piece& p : pieces_) {
      auto& base = work_.base[static_cast<std::size_t>(p.component)];
      if (p.low <= p.high) base = std::min(base, p.low - kBeyond);
    }
    for (auto* v : {&work_.unary, &work_.row, &work_.right, &work_.up, &work_.down}) v->resize(pieces_.size());
    for (std::size_t i = 0; i < pieces_.size(); ++i) price(i);
  }

  /// The code's evidence for the shifts that the range allows, a little beyond it, as far as the states reach and
  /// within the projector's frame.
  void price(std::size_t i) {
    const Piece& p = pieces_[i];
    auto& unary = work_.unary[i].of;
    unary.fill(kImpossible);
    const std::int32_t base = base_of(p);
    const std::int32_t first = std::max({base, p.low - kBeyond, first_in_frame(p.cell)});
    const std::int32_t last = std::min({base + kStates - 1, p.high + kBeyond, (evidence_.cells() - 1 - p.cell) >> 1});
    if (first > last) return;
    std::array<float, kOrderStates> nats;
    evidence_.costs(i, p.cell + 2 * first, {nats.data(), static_cast<std::size_t>(last - first + 1)});
    for (std::int32_t shift = first; shift <= last; ++shift) {
      const auto beyond = static_cast<float>(std::max({p.low - shift, shift - p.high, 0}));
      const float cost = nats[static_cast<std::size_t>(shift - first)] + config_.beyond_range_cost * beyond;
      unary[static_cast<std::size_t>(shift - base)] = to_cost(std::min(cost, kImpossible_nats));
    }
  }

  /// Least shift that brings the cell to 0 or more.
  static std::int32_t first_in_frame(std::int32_t cell) { return -(cell >> 1); }

  std::int32_t base_of(const Piece& p) const {
    const std::int32_t b = work_.base[static_cast<std::size_t>(p.component)];
    return b == std::numeric_limits<std::int32_t>::max() ? 0 : b;
  }

  Cost jump_cost(const Piece& p) const { return to_cost(p.kink ? config_.kink_jump_cost : config_.unseen_jump_cost); }

  /// What piece i thinks of the shifts of the piece before it in the row, beyond a gap.
  GapCosts gap_before(std::size_t i) const {
    const Gap& gap = pieces_[i].gap;
    const Cost skip = to_cost(gap.contact ? config_.missed_contact_cost : 0);
    const Cost fold = to_cost(config_.fold_cost + (gap.contact ? config_.missed_contact_cost : 0));
    const std::int32_t lean = gap.lean + base_of(pieces_[i - 1]) - base_of(pieces_[i]);
    return gap.rise > 0 ? GapCosts{lean, skip, fold} : GapCosts{lean, fold, skip};
  }

  /// Message of piece `from` to its neighbour in the row, `to`, with that one's own evidence added.
  void tell(const std::vector<OrderCosts>& said, std::size_t from, std::size_t to, std::vector<OrderCosts>& out) const {
    const Piece& later = pieces_[std::max(from, to)];
    if (later.joined) {
      pass_joined(said[from], work_.unary[to], jump_cost(later), out[to]);
    } else if (later.gap.rise != 0) {
      const GapCosts g = gap_before(std::max(from, to));
      pass_gap(said[from], work_.unary[to], from < to ? g : GapCosts{-g.lean, g.below, g.above}, out[to]);
    } else {
      pass_joined({}, work_.unary[to], 0, out[to]);
    }
  }

  /// Forward messages of each row, in `row`, and backward ones; then row = their sum, the piece's own evidence once.
  void along_rows() {
    const std::size_t n = pieces_.size();
    if (n == 0) return;
    pass_joined({}, work_.unary[0], 0, work_.row[0]);
    for (std::size_t i = 1; i < n; ++i) tell(work_.row, i - 1, i, work_.row);
    pass_joined({}, work_.unary[n - 1], 0, work_.right[n - 1]);
    for (std::size_t i = n - 1; i-- > 0;) tell(work_.right, i + 1, i, work_.right);
    for (std::size_t i = 0; i < n; ++i) {
      auto& row = work_.row[i].of;
      for (std::size_t k = 0; k < kOrderStates; ++k)
        row[k] = static_cast<Cost>(row[k] + work_.right[i].of[k] - work_.unary[i].of[k]);
    }
  }

  /// Running means over the rows above and below. A mean, not a sum: what misleads the code (an edge, a moving shadow)
  /// misleads many rows alike, so that repeating it makes it no truer.
  void between_rows() {
    const std::size_t n = pieces_.size();
    for (std::size_t i = 0; i < n; ++i) mean_of_rows(work_.up, pieces_[i].up, i);
    for (std::size_t i = n; i-- > 0;) mean_of_rows(work_.down, pieces_[i].down, i);
  }

  void mean_of_rows(std::vector<OrderCosts>& mean, std::int32_t neighbour, std::size_t i) {
    const OrderCosts& own = work_.row[i];
    const bool linked = neighbour >= 0;
    blend(linked ? mean[static_cast<std::size_t>(neighbour)] : own, own, linked ? config_.row_memory : 0,
          to_cost(4 * config_.unseen_jump_cost), mean[i]);
  }

  void choose() {
    const Cost margin = to_cost(config_.decided_margin);
    out_.pieces.assign(pieces_.size(), {});
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      OrderCosts total;
      for (std::size_t k = 0; k < kOrderStates; ++k)
        total.of[k] = static_cast<Cost>((work_.up[i].of[k] + work_.down[i].of[k]) / 2);
      const auto best = std::min_element(total.of.begin(), total.of.end());
      const Cost first = *best;
      *best = kImpossible;
      out_.pieces[i].shift = base_of(pieces_[i]) + static_cast<std::int32_t>(best - total.of.begin());
      out_.pieces[i].decided = first < kImpossible && least(total) - first >= margin;
    }
  }

  /// Calls visit(other) for the pieces linked to piece i that come before it in the list, and for the one below.
  template <class Visit>
  void neighbours(std::size_t i, Visit visit) const {
    const Piece& p = pieces_[i];
    if (p.joined && !p.kink) visit(i - 1);
    if (p.up >= 0) visit(static_cast<std::size_t>(p.up));
    if (p.down >= 0) visit(static_cast<std::size_t>(p.down));
  }

  /// A zone of undecided pieces that borders on decided ones of one shift only continues that surface: plain
  /// unwrapping. Where two shifts meet in it nobody knows the place, and where its own code speaks against, it stays
  /// undecided.
  void inherit() {
    reset_sets();
    const auto undecided = [&](std::size_t i) { return !out_.pieces[i].decided; };
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      neighbours(i, [&](std::size_t o) {
        if (undecided(i) && undecided(o)) unite(i, o);
      });
    }
    constexpr std::int32_t kUnknown = std::numeric_limits<std::int32_t>::max(), kSeveral = kUnknown - 1;
    work_.size.assign(pieces_.size(), kUnknown);  // the shift around each zone, at its root
    const auto note = [&](std::size_t zone, std::size_t source) {
      std::int32_t& known = work_.size[root(zone)];
      const std::int32_t shift = out_.pieces[source].shift;
      known = known == kUnknown || known == shift ? shift : kSeveral;
    };
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      neighbours(i, [&](std::size_t o) {
        if (undecided(i) && !undecided(o)) note(i, o);
        if (!undecided(i) && undecided(o)) note(o, i);
      });
    }
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      if (!undecided(i) || work_.size[root(i)] >= kSeveral) continue;
      const std::int32_t shift = work_.size[root(i)], state = shift - base_of(pieces_[i]);
      if (state < 0 || state >= kStates) continue;
      const OrderCosts& total = work_.row[i];  // of its own row, not diluted by others
      if (total.of[static_cast<std::size_t>(state)] - least(total) > to_cost(config_.inherit_cost)) continue;
      out_.pieces[i].shift = shift;
      out_.pieces[i].inherited = true;
    }
    for (PieceOrder& o : out_.pieces) o.decided = o.decided || o.inherited;
  }

  void count_seams() {
    out_.seams = out_.torn_seams = 0;
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      if (!pieces_[i].joined || pieces_[i].kink) continue;
      ++out_.seams;
      out_.torn_seams += out_.pieces[i].shift != out_.pieces[i - 1].shift ? 1U : 0U;
    }
  }

  void reset_sets() {
    work_.parent.resize(pieces_.size());
    std::iota(work_.parent.begin(), work_.parent.end(), 0);
  }

  std::size_t root(std::size_t i) {
    while (static_cast<std::size_t>(work_.parent[i]) != i) {
      work_.parent[i] = work_.parent[static_cast<std::size_t>(work_.parent[i])];
      i = static_cast<std::size_t>(work_.parent[i]);
    }
    return i;
  }

  void unite(std::size_t a, std::size_t b) {
    a = root(a), b = root(b);
    if (a != b) work_.parent[std::max(a, b)] = static_cast<std::int32_t>(std::min(a, b));
  }

  void find_specks() {
    reset_sets();
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      neighbours(i, [&](std::size_t o) {
        const PieceOrder &a = out_.pieces[i], &b = out_.pieces[o];
        if (a.decided && b.decided && a.shift == b.shift) unite(i, o);
      });
    }
    work_.size.assign(pieces_.size(), 0);
    for (std::size_t i = 0; i < pieces_.size(); ++i) work_.size[root(i)] += pieces_[i].end - pieces_[i].begin;
    for (std::size_t i = 0; i < pieces_.size(); ++i)
      out_.pieces[i].speck = out_.pieces[i].decided && work_.size[root(i)] < config_.min_region_px;
  }

  const std::vector<Piece>& pieces_;
  const CodeEvidence& evidence_;
  const OrderConfig& config_;
  OrderResult& out_;
  OrderResult::Work& work_;
};

}  // namespace

void find_orders(const std::vector<Piece>& pieces, std::int32_t components, const CodeEvidence& evidence,
                 const OrderConfig& config, OrderResult& out) {
  Solver(pieces, evidence, config, out).run(components);
}

void judge_orders(const std::vector<Piece>& pieces, const CodeEvidence& evidence, OrderResult& out) {
  out.agreeing_px = out.contradicting_px = 0;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const Piece& p = pieces[i];
    const PieceOrder& o = out.pieces[i];
    const Stance stance = o.decided ? evidence.stance(i, p.cell + 2 * o.shift) : Stance::kSilent;
    if (stance == Stance::kAgrees) out.agreeing_px += p.end - p.begin;
    if (stance == Stance::kContradicts) out.contradicting_px += p.end - p.begin;
  }
}

}  // namespace enamel::algo
