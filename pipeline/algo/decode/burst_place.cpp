// BurstDecoder's middle step: absolute fringe orders.
#include <algorithm>
#include <cmath>
#include <vector>

#include "pipeline/algo/decode/burst_gates.hpp"
#include "pipeline/algo/decode/decode_buffers.hpp"
#include "pipeline/algo/decode/relative_regions.hpp"

namespace enamel::algo {
namespace {

/// Spans of decided pieces; the others' pixels are rejected.
void make_spans(const std::vector<Piece>& pieces, const OrderResult& orders, Map<PixelReject>& reject,
                std::vector<CellSpan>& spans) {
  spans.clear();
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const Piece& p = pieces[k];
    const PieceOrder& o = orders.pieces[k];
    if (o.decided && !o.speck) {
      const bool whole = p.joined && k + 1 < pieces.size() && pieces[k + 1].joined;
      spans.push_back({p.row, p.begin, p.end, p.cell + 2 * o.shift, whole});
      continue;
    }
    const PixelReject why = o.decided ? PixelReject::kSpeck : PixelReject::kRelative;
    std::fill(&reject(p.begin, p.row), &reject(p.begin, p.row) + (p.end - p.begin), why);
  }
}

}  // namespace

/// Absolute orders of all pieces, and whether the code that they rest on is the rig's.
BurstVerdict BurstDecoder::place(DecodeWorkspace& workspace, DecodedBurst& out) const {
  auto& b = *workspace.buffers_;
  DecodeDiagnostics& diag = out.diagnostics;
  const auto& pieces = b.pieces.pieces;
  static const Map<std::uint8_t> kNoCuts;
  if (micro_) find_code_steps(b.phase, diag.noise, *micro_, b.flood, config_.order.unseen_jump_cost, b.steps);
  find_pieces(b.phase, b.links, b.flood, {rays_->phase_near_rad.data(), rays_->phase_far_rad.data()},
              micro_ ? b.steps.cut : kNoCuts, b.pieces);
  if (micro_) {
    b.micro_evidence.measure(b.phase, diag.noise, pieces, *micro_, config_.order.outlier_cost);
    find_orders(pieces, b.flood.components, b.micro_evidence, config_.order, b.orders);
    diag.code_turn_rad = b.micro_evidence.settle(pieces, b.orders);
    judge_orders(pieces, b.micro_evidence, b.orders);
  } else {
    b.polarity_evidence.measure(b.phase, diag.noise, pieces, signs_, config_.order.outlier_cost);
    find_orders(pieces, b.flood.components, b.polarity_evidence, config_.order, b.orders);
    judge_orders(pieces, b.polarity_evidence, b.orders);
  }
  make_spans(pieces, b.orders, b.phase.reject, b.spans);
  find_relative(pieces, b.orders.pieces, config_.order.min_region_px, b.orders.work.parent, out.relative);
  const double judged = b.orders.agreeing_px + b.orders.contradicting_px;
  diag.code_agreement = judged > 0 ? b.orders.agreeing_px / judged : 0;
  diag.torn_share =
      b.orders.seams > 0 ? static_cast<double>(b.orders.torn_seams) / static_cast<double>(b.orders.seams) : 0;
  if (b.spans.empty()) {
    const bool blinded = b.saturated.size() > count_of(b.phase, PixelReject::kRelative) / 2;
    const bool torn = !micro_ && diag.closure_share < config_.min_unplaced_closure_share;
    return blinded ? BurstVerdict::kSaturated : (torn ? BurstVerdict::kPatternMismatch : BurstVerdict::kNoCode);
  }
  const bool informative = micro_ || signs_.informative;
  const bool follows = diag.code_agreement >= config_.min_code_agreement && diag.torn_share <= config_.max_torn_share;
  const bool turned = micro_ && std::abs(diag.code_turn_rad) > max_code_turn_rad(micro_->ratio());
  return informative && (!follows || turned) ? BurstVerdict::kPatternMismatch : BurstVerdict::kAccepted;
}

}  // namespace enamel::algo
