#include "pipeline/algo/unwrap/order.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "pipeline/algo/phase/poly_trig.hpp"

namespace enamel::algo {
namespace {

constexpr std::size_t kStates = 16;  ///< shifts per component, from two below the lowest that any piece allows
constexpr std::int32_t kBeyond = 2;  ///< orders beyond the depth range that a surface is followed
constexpr float kImpossible = 60;
using Costs = std::array<float, kStates>;

float* at(std::vector<float>& v, std::size_t piece) { return &v[piece * kStates]; }

/// Least of kStates costs, in four lanes.
float least(const float* c) {
  std::array<float, 4> m = {c[0], c[1], c[2], c[3]};
  for (std::size_t k = 4; k < kStates; k += 4)
    for (std::size_t j = 0; j < 4; ++j) m[j] = smaller(m[j], c[k + j]);
  return smaller(smaller(m[0], m[1]), smaller(m[2], m[3]));
}

/// out[k] = unary[k] + min(in[k], min(in) + jump), less its own minimum so that sums stay small.
void pass(const float* in, const float* unary, float jump, float* out) {
  const float low = least(in);
  Costs sum;  // apart from in and out, which may be the same: the loops vectorise
  for (std::size_t k = 0; k < kStates; ++k) sum[k] = unary[k] + smaller(in[k] - low, jump);
  const float base = least(sum.data());
  for (std::size_t k = 0; k < kStates; ++k) out[k] = sum[k] - base;
}

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
    for (auto* v : {&work_.unary, &work_.row, &work_.right, &work_.up, &work_.down})
      v->resize(pieces_.size() * kStates);
    const std::int32_t cells = evidence_.cells();
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      const Piece& p = pieces_[i];
      float* unary = at(work_.unary, i);
      std::fill_n(unary, kStates, kImpossible);
      // Shifts that the range allows, a little beyond it, as far as the states reach and within the projector's frame.
      const std::int32_t base = base_of(p), last_state = base + static_cast<std::int32_t>(kStates) - 1;
      const std::int32_t first = std::max({base, p.low - kBeyond, first_in_frame(p.cell)});
      const std::int32_t last = std::min({last_state, p.high + kBeyond, (cells - 1 - p.cell) >> 1});
      if (first > last) continue;
      float* out = unary + (first - base);
      evidence_.costs(i, p.cell + 2 * first, {out, static_cast<std::size_t>(last - first + 1)});
      for (std::int32_t shift = first; shift <= last; ++shift) {
        out[shift - first] +=
            config_.beyond_range_cost * static_cast<float>(std::max({p.low - shift, shift - p.high, 0}));
      }
    }
  }

  /// Least shift that brings the cell to 0 or more.
  static std::int32_t first_in_frame(std::int32_t cell) { return -(cell >> 1); }

  std::int32_t base_of(const Piece& p) const {
    const std::int32_t b = work_.base[static_cast<std::size_t>(p.component)];
    return b == std::numeric_limits<std::int32_t>::max() ? 0 : b;
  }

  float jump_cost(const Piece& p) const { return p.kink ? config_.kink_jump_cost : config_.unseen_jump_cost; }

  /// Forward messages of each run, in `row`, and backward ones; then row = their sum, the piece's own evidence once.
  void along_rows() {
    const Costs none{};
    const std::size_t n = pieces_.size();
    for (std::size_t i = 0; i < n; ++i) {
      pass(pieces_[i].joined ? at(work_.row, i - 1) : none.data(), at(work_.unary, i), jump_cost(pieces_[i]),
           at(work_.row, i));
    }
    for (std::size_t i = n; i-- > 0;) {
      pass(i + 1 < n && pieces_[i + 1].joined ? at(work_.right, i + 1) : none.data(), at(work_.unary, i),
           i + 1 < n ? jump_cost(pieces_[i + 1]) : 0, at(work_.right, i));
    }
    for (std::size_t i = 0; i < n; ++i) {
      float* __restrict row = at(work_.row, i);
      const float* __restrict right = at(work_.right, i);
      const float* __restrict unary = at(work_.unary, i);
      for (std::size_t k = 0; k < kStates; ++k) row[k] = row[k] + right[k] - unary[k];
    }
  }

  /// Running means over the rows above and below. A mean, not a sum: what misleads the code (an edge, a moving shadow)
  /// misleads many rows alike, so that repeating it makes it no truer.
  void between_rows() {
    const std::size_t n = pieces_.size();
    for (std::size_t i = 0; i < n; ++i) blend(work_.up, pieces_[i].up, i);
    for (std::size_t i = n; i-- > 0;) blend(work_.down, pieces_[i].down, i);
  }

  void blend(std::vector<float>& mean, std::int32_t neighbour, std::size_t i) {
    const float memory = neighbour >= 0 ? config_.row_memory : 0;
    const float* own = at(work_.row, i);
    const float* in = neighbour >= 0 ? at(mean, static_cast<std::size_t>(neighbour)) : own;
    const float low = least(in), own_low = least(own);
    float* __restrict out = at(mean, i);
    for (std::size_t k = 0; k < kStates; ++k)
      out[k] = (1 - memory) * (own[k] - own_low) + memory * smaller(in[k] - low, 4 * config_.unseen_jump_cost);
  }

  void choose() {
    out_.pieces.assign(pieces_.size(), {});
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      Costs total;
      const float* up = at(work_.up, i);
      const float* down = at(work_.down, i);
      for (std::size_t k = 0; k < kStates; ++k) total[k] = 0.5F * (up[k] + down[k]);
      float first = kImpossible, second = kImpossible;
      std::size_t best = 0;
      for (std::size_t k = 0; k < kStates; ++k) {
        if (total[k] < first) {
          second = first;
          first = total[k];
          best = k;
        } else {
          second = smaller(second, total[k]);
        }
      }
      out_.pieces[i].shift = base_of(pieces_[i]) + static_cast<std::int32_t>(best);
      out_.pieces[i].decided = first < kImpossible && second - first >= config_.decided_margin;
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
      if (state < 0 || state >= static_cast<std::int32_t>(kStates)) continue;
      const float* total = at(work_.row, i);  // of its own row, not diluted by others
      if (total[state] - least(total) > config_.inherit_cost) continue;
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
