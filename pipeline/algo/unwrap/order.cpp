#include "pipeline/algo/unwrap/order.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

namespace enamel::algo {
namespace {

constexpr std::size_t kStates = 16;  ///< shifts per component, from the lowest that any of its pieces allows
using Costs = std::array<float, kStates>;

float* at(std::vector<float>& v, std::size_t piece) { return &v[piece * kStates]; }

/// out[k] = unary[k] + min(in[k], min(in) + jump), less its own minimum so that sums stay small.
void pass(const float* in, const float* unary, float jump, float* out) {
  const float low = *std::min_element(in, in + kStates);
  for (std::size_t k = 0; k < kStates; ++k) out[k] = unary[k] + std::min(in[k] - low, jump);
  const float base = *std::min_element(out, out + kStates);
  for (std::size_t k = 0; k < kStates; ++k) out[k] -= base;
}

float disagreement(const Piece& p, float sign, const OrderConfig& c) {
  const float d = p.code - sign;
  return std::min(0.5F * d * d / p.code_variance, c.outlier_cost);
}

class Solver {
 public:
  Solver(const std::vector<Piece>& pieces, const CellSigns& signs, const OrderConfig& config, OrderResult& out)
      : pieces_(pieces), signs_(signs), config_(config), out_(out), work_(out.work) {}

  void run(std::int32_t components) {
    prepare(components);
    along_rows();
    between_rows();
    choose();
    find_specks();
  }

 private:
  void prepare(std::int32_t components) {
    work_.base.assign(static_cast<std::size_t>(components), std::numeric_limits<std::int32_t>::max());
    for (const Piece& p : pieces_) {
      auto& base = work_.base[static_cast<std::size_t>(p.component)];
      if (p.low <= p.high) base = std::min(base, p.low);
    }
    for (auto* v : {&work_.unary, &work_.left, &work_.right, &work_.row, &work_.up, &work_.down})
      v->resize(pieces_.size() * kStates);
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      const Piece& p = pieces_[i];
      const float plus = signs_.informative ? disagreement(p, 1, config_) : 0;
      const float minus = signs_.informative ? disagreement(p, -1, config_) : 0;
      for (std::size_t k = 0; k < kStates; ++k) {
        const std::int32_t shift = base_of(p) + static_cast<std::int32_t>(k);
        const std::int32_t cell = p.cell + 2 * shift;
        const bool possible = shift >= p.low && shift <= p.high && cell >= 0 && cell < signs_.cells();
        at(work_.unary, i)[k] = possible ? (signs_.at(cell) > 0 ? plus : minus) : config_.out_of_range_cost;
      }
    }
  }

  std::int32_t base_of(const Piece& p) const {
    const std::int32_t b = work_.base[static_cast<std::size_t>(p.component)];
    return b == std::numeric_limits<std::int32_t>::max() ? 0 : b;
  }

  /// Forward and backward messages of each run; row = sum of both with the piece's own evidence counted once.
  void along_rows() {
    const Costs none{};
    const std::size_t n = pieces_.size();
    for (std::size_t i = 0; i < n; ++i)
      pass(pieces_[i].joined ? at(work_.left, i - 1) : none.data(), at(work_.unary, i), config_.unseen_jump_cost,
           at(work_.left, i));
    for (std::size_t i = n; i-- > 0;)
      pass(i + 1 < n && pieces_[i + 1].joined ? at(work_.right, i + 1) : none.data(), at(work_.unary, i),
           config_.unseen_jump_cost, at(work_.right, i));
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t k = 0; k < kStates; ++k)
        at(work_.row, i)[k] = at(work_.left, i)[k] + at(work_.right, i)[k] - at(work_.unary, i)[k];
  }

  void between_rows() {
    const Costs none{};
    const std::size_t n = pieces_.size();
    for (std::size_t i = 0; i < n; ++i)
      pass(pieces_[i].up >= 0 ? at(work_.up, static_cast<std::size_t>(pieces_[i].up)) : none.data(), at(work_.row, i),
           config_.unseen_jump_cost, at(work_.up, i));
    for (std::size_t i = n; i-- > 0;)
      pass(pieces_[i].down >= 0 ? at(work_.down, static_cast<std::size_t>(pieces_[i].down)) : none.data(),
           at(work_.row, i), config_.unseen_jump_cost, at(work_.down, i));
  }

  void choose() {
    out_.pieces.assign(pieces_.size(), {});
    out_.agreeing_px = out_.contradicting_px = 0;
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      Costs total{};
      for (std::size_t k = 0; k < kStates; ++k)
        total[k] = at(work_.up, i)[k] + at(work_.down, i)[k] - at(work_.row, i)[k];
      const auto best = static_cast<std::size_t>(std::min_element(total.begin(), total.end()) - total.begin());
      float second = std::numeric_limits<float>::max();
      for (std::size_t k = 0; k < kStates; ++k)
        if (k != best) second = std::min(second, total[k]);
      const Piece& p = pieces_[i];
      PieceOrder& o = out_.pieces[i];
      o.shift = base_of(p) + static_cast<std::int32_t>(best);
      const bool possible = o.shift >= p.low && o.shift <= p.high;
      o.decided = possible && second - total[best] >= config_.decided_margin;
      if (!o.decided || p.code_variance > 0.25F) continue;
      const bool agrees = p.code * signs_.at(p.cell + 2 * o.shift) > 0;
      (agrees ? out_.agreeing_px : out_.contradicting_px) += p.end - p.begin;
    }
  }

  std::size_t root(std::size_t i) {
    while (static_cast<std::size_t>(work_.parent[i]) != i) {
      work_.parent[i] = work_.parent[static_cast<std::size_t>(work_.parent[i])];
      i = static_cast<std::size_t>(work_.parent[i]);
    }
    return i;
  }

  void unite(std::size_t a, std::size_t b) {
    if (!out_.pieces[a].decided || !out_.pieces[b].decided || out_.pieces[a].shift != out_.pieces[b].shift) return;
    a = root(a), b = root(b);
    if (a == b) return;
    work_.parent[std::max(a, b)] = static_cast<std::int32_t>(std::min(a, b));
    work_.size[std::min(a, b)] += work_.size[std::max(a, b)];
  }

  void find_specks() {
    work_.parent.resize(pieces_.size());
    std::iota(work_.parent.begin(), work_.parent.end(), 0);
    work_.size.resize(pieces_.size());
    for (std::size_t i = 0; i < pieces_.size(); ++i) work_.size[i] = pieces_[i].end - pieces_[i].begin;
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      if (pieces_[i].joined) unite(i, i - 1);
      if (pieces_[i].up >= 0) unite(i, static_cast<std::size_t>(pieces_[i].up));
      if (pieces_[i].down >= 0) unite(i, static_cast<std::size_t>(pieces_[i].down));
    }
    for (std::size_t i = 0; i < pieces_.size(); ++i)
      out_.pieces[i].speck = out_.pieces[i].decided && work_.size[root(i)] < config_.min_region_px;
  }

  const std::vector<Piece>& pieces_;
  const CellSigns& signs_;
  const OrderConfig& config_;
  OrderResult& out_;
  OrderResult::Work& work_;
};

}  // namespace

void find_orders(const std::vector<Piece>& pieces, std::int32_t components, const CellSigns& signs,
                 const OrderConfig& config, OrderResult& out) {
  Solver(pieces, signs, config, out).run(components);
}

}  // namespace enamel::algo
