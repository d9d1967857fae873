#include "pipeline/algo/unwrap/order.hpp"

#include <algorithm>
#include <limits>

#include "pipeline/algo/unwrap/order_rows.hpp"
#include "pipeline/algo/unwrap/piece_sets.hpp"

namespace enamel::algo {
namespace {

constexpr auto kStates = static_cast<std::int32_t>(kOrderStates);

class Solver {
 public:
  Solver(const std::vector<Piece>& pieces, const CodeEvidence& evidence, const OrderConfig& config, OrderResult& out)
      : pieces_(pieces), evidence_(evidence), config_(config), out_(out), work_(out.work) {}

  void run(std::int32_t components) {
    label_rows(pieces_, components, evidence_, config_, out_);
    inherit();
    count_seams();
    find_specks();
  }

 private:
  /// A zone of undecided pieces that borders on decided ones of one shift only continues that surface: plain
  /// unwrapping. Where two shifts meet in it nobody knows the place, and where its own code speaks against, it stays
  /// undecided.
  void inherit() {
    const auto undecided = [&](std::size_t i) { return !out_.pieces[i].decided; };
    const auto decided = [](const PieceOrder& o) { return o.decided; };
    if (std::all_of(out_.pieces.begin(), out_.pieces.end(), decided)) return;
    work_.open.clear();  // neighbours of which one or both are undecided
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      const bool own = undecided(i);
      each_neighbour(pieces_[i], i, [&](std::size_t o) {
        if (own || undecided(o)) work_.open.emplace_back(static_cast<std::int32_t>(i), static_cast<std::int32_t>(o));
      });
    }
    PieceSets sets(pieces_.size(), work_.parent);
    const auto both = [&](auto visit) {
      for (const auto& [i, o] : work_.open) visit(static_cast<std::size_t>(i), static_cast<std::size_t>(o));
    };
    both([&](std::size_t i, std::size_t o) {
      if (undecided(i) && undecided(o)) sets.unite(i, o);
    });
    constexpr std::int32_t kUnknown = std::numeric_limits<std::int32_t>::max(), kSeveral = kUnknown - 1;
    work_.size.assign(pieces_.size(), kUnknown);  // the shift around each zone, at its root
    const auto note = [&](std::size_t zone, std::size_t source) {
      std::int32_t& known = work_.size[sets.root(zone)];
      const std::int32_t shift = out_.pieces[source].shift;
      known = known == kUnknown || known == shift ? shift : kSeveral;
    };
    both([&](std::size_t i, std::size_t o) {
      if (!undecided(o)) note(i, o);
      if (!undecided(i)) note(o, i);
    });
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      if (!undecided(i) || work_.size[sets.root(i)] >= kSeveral) continue;
      const std::int32_t shift = work_.size[sets.root(i)], state = shift - base_shift(work_, pieces_[i]);
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

  void find_specks() {
    PieceSets sets(pieces_.size(), work_.parent);
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      each_neighbour(pieces_[i], i, [&](std::size_t o) {
        const PieceOrder &a = out_.pieces[i], &b = out_.pieces[o];
        if (a.decided && b.decided && a.shift == b.shift) sets.unite(i, o);
      });
    }
    work_.size.assign(pieces_.size(), 0);
    for (std::size_t i = 0; i < pieces_.size(); ++i) work_.size[sets.root(i)] += pieces_[i].end - pieces_[i].begin;
    for (std::size_t i = 0; i < pieces_.size(); ++i)
      out_.pieces[i].speck = out_.pieces[i].decided && work_.size[sets.root(i)] < config_.min_region_px;
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
