// BurstDecoder's middle step: absolute fringe orders.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "pipeline/decode/decode_buffers.hpp"
#include "pipeline/decode/mode_m/likely_turns.hpp"
#include "pipeline/decode/mode_m/micro_gates.hpp"
#include "pipeline/decode/mode_m/micro_phase.hpp"
#include "pipeline/decode/mode_m/micro_view.hpp"
#include "pipeline/decode/mode_t/closure_gates.hpp"
#include "pipeline/decode/steps/frame_gates.hpp"
#include "pipeline/decode/steps/relative_regions.hpp"

namespace enamel::pipeline {
namespace {

/// Spans of decided pieces.
void make_spans(const std::vector<Piece>& pieces, const OrderResult& orders, std::vector<CellSpan>& spans) {
  spans.clear();
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const Piece& p = pieces[k];
    const PieceOrder& o = orders.pieces[k];
    if (!o.decided || o.speck) continue;
    const bool whole = p.joined && k + 1 < pieces.size() && pieces[k + 1].joined;
    spans.push_back({p.row, p.begin, p.end, p.cell + 2 * o.shift, whole});
  }
}

/// Of all other pieces.
void reject_undecided(const std::vector<Piece>& pieces, const OrderResult& orders, Map<PixelReject>& reject) {
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const Piece& p = pieces[k];
    const PieceOrder& o = orders.pieces[k];
    if (o.decided && !o.speck) continue;
    const PixelReject why = o.decided ? PixelReject::kSpeck : PixelReject::kRelative;
    std::fill(&reject(p.begin, p.row), &reject(p.begin, p.row) + (p.end - p.begin), why);
  }
}

/// Beside a jump of whole fringes inside a run, where the phase goes on as if there were none: blur makes the
/// pixels there see both sides, and the code places the jump to within a pixel.
void reject_torn(const std::vector<Piece>& pieces, const OrderResult& orders, Map<PixelReject>& reject) {
  constexpr std::int32_t kTorn_px = 2;  // one that blur mixes, one that the code may be off by
  for (std::size_t k = 1; k < pieces.size(); ++k) {
    const Piece &before = pieces[k - 1], &p = pieces[k];
    const PieceOrder &a = orders.pieces[k - 1], &b = orders.pieces[k];
    if (!p.joined || !a.decided || !b.decided || a.shift == b.shift) continue;
    const std::int32_t first = std::max(before.begin, p.begin - kTorn_px), end = std::min(p.end, p.begin + kTorn_px);
    for (std::int32_t u = first; u < end; ++u) {
      if (reject(u, p.row) == PixelReject::kNone) reject(u, p.row) = PixelReject::kEdge;
    }
  }
}

constexpr float kBeyondRange = 0.15F;  ///< of the ends of the depth range: surfaces run on beyond it

double judged_px(const OrderResult& orders) { return orders.agreeing_px + orders.contradicting_px; }

bool unclear(const OrderResult& orders, const DecodeConfig& config) {
  return orders.agreeing_px < config.clear_code_agreement * judged_px(orders);
}

/// The motion that turns the code by an angle against the three phase frames, which were taken 2/3 of an interval
/// later.
float motion_of_turn(float turn_rad, const MicroCode& code) {
  return -turn_rad / ((1 + code.inverse_ratio) * (2.0F / 3));
}

/// Of what motion changes; the rest of `a` stays.
void swap_measured(PhaseMaps& a, PhaseMaps& b) {
  std::swap(a.mean_dn, b.mean_dn), std::swap(a.cosine_dn, b.cosine_dn), std::swap(a.sine_dn, b.sine_dn);
  std::swap(a.code_dn, b.code_dn), std::swap(a.modulation_dn, b.modulation_dn);
  std::swap(a.phase_rad, b.phase_rad);
}

}  // namespace

void BurstDecoder::label(DecodeWorkspace::Buffers& b, const NoiseModel& noise) const {
  static const Map<std::uint8_t> kNoCuts;
  find_pieces(b.phase, b.links, b.flood, {rays_->phase_near_rad.data(), rays_->phase_far_rad.data()}, kNoCuts,
              b.pieces);
  b.polarity_evidence.measure(b.phase, noise, b.pieces.pieces, signs_, config_.order.outlier_cost);
  find_orders(b.pieces.pieces, b.flood.components, b.polarity_evidence, config_.order, b.orders);
  judge_orders(b.pieces.pieces, b.polarity_evidence, b.orders);
}

/// Returns the mean angle of the code against the orders found.
float BurstDecoder::label_by_code(DecodeWorkspace::Buffers& b, const NoiseModel& noise) const {
  find_code_steps(b.phase, noise, *micro_, b.flood, config_.order.unseen_jump_cost, b.steps);
  find_pieces(b.phase, b.links, b.flood, {rays_->phase_near_rad.data(), rays_->phase_far_rad.data()}, b.steps.cut,
              b.pieces);
  b.micro_evidence.measure(b.phase, noise, b.pieces.pieces, *micro_, config_.order.outlier_cost);
  find_orders(b.pieces.pieces, b.flood.components, b.micro_evidence, config_.order, b.orders);
  const float turn = b.micro_evidence.settle(b.pieces.pieces, b.orders);
  judge_orders(b.pieces.pieces, b.micro_evidence, b.orders);
  return turn;
}

/// Motion ripples the phase and turns the code, so that pieces of one surface seem to differ, and light that changes as
/// the surface passes by is taken for code. The orders found in spite of it show the motion; without it they are found
/// again. The phase stays as it was measured.
void BurstDecoder::label_less_motion(DecodeWorkspace::Buffers& b, DecodeDiagnostics& diag) const {
  make_spans(b.pieces.pieces, b.orders, b.spans);
  place_spans(b.spans, {}, b.phase.phase_rad.width(), b.phase.phase_rad.height(), b.polarity.turn);
  MicroRefitConfig coarse = config_.micro_refit;
  coarse.row_step *= 2;  // half the rows tell what turns the code by degrees; the phase has a fit of its own
  fit_micro_motion(b.polarity.turn, *micro_, 0, diag.noise, coarse, b.phase, b.micro_motion);
  if (unclear(b.orders, config_) && config_.motion_passes > 0) {
    const Map<float>& image = b.phase.phase_rad;
    find_likely_turns(b.pieces.pieces, b.orders.pieces, b.flood.components, image.width(), image.height(), b.likely);
    const Map<std::int16_t>& turn = b.likely.turn;
    MicroView view({b.polarity.turn, turn, kBeyondRange, *micro_, 0, b.phase, *rays_, b.micro_motion,
                    config_.rigid.max_residual, false});
    if (fit_rigid_motion(view, b.phase, turn, *rays_, config_.motion_passes, config_.rigid, b.rigid, b.field).moved)
      b.micro_motion.surface = surface_motion(b.field);
  }
  move_to_code_frame(b.micro_motion, b.phase, b.moved);
  swap_measured(b.phase, b.moved);
  label_by_code(b, diag.noise);
  swap_measured(b.phase, b.moved);
}

/// Absolute orders of all pieces, and whether the code that they rest on is the rig's.
BurstVerdict BurstDecoder::place(DecodeWorkspace& workspace, DecodedBurst& out) const {
  auto& b = *workspace.buffers_;
  DecodeDiagnostics& diag = out.diagnostics;
  const auto& pieces = b.pieces.pieces;
  if (micro_) {
    diag.code_turn_rad = label_by_code(b, diag.noise);
    const bool moved = std::abs(motion_of_turn(diag.code_turn_rad, *micro_)) > config_.harmless_motion_rad;
    if (config_.correct_closure && (moved || unclear(b.orders, config_))) {
      label_less_motion(b, diag);
      // More orders show the motion better, which once more brings more of them.
      if (unclear(b.orders, config_)) label_less_motion(b, diag);
    }
  } else {
    label(b, diag.noise);
  }
  make_spans(pieces, b.orders, b.spans);
  reject_undecided(pieces, b.orders, b.phase.reject);
  reject_torn(pieces, b.orders, b.phase.reject);
  find_relative(pieces, b.orders.pieces, config_.order.min_region_px, b.orders.work.parent, out.relative);
  const double judged = judged_px(b.orders);
  diag.code_agreement = judged > 0 ? b.orders.agreeing_px / judged : 0;
  diag.torn_share =
      b.orders.seams > 0 ? static_cast<double>(b.orders.torn_seams) / static_cast<double>(b.orders.seams) : 0;
  if (b.spans.empty()) {
    const bool blinded = b.saturated.size() > count_of(b.phase, PixelReject::kRelative) / 2;
    const bool mixed = diag.repeated_share > config_.max_unplaced_repeated_share ||
                       diag.direction_share < config_.min_unplaced_direction_share;
    const bool torn = micro_ ? mixed : diag.closure_share < config_.min_unplaced_closure_share;
    return blinded ? BurstVerdict::kSaturated : (torn ? BurstVerdict::kPatternMismatch : BurstVerdict::kNoCode);
  }
  const bool follows = diag.code_agreement >= config_.min_code_agreement && diag.torn_share <= config_.max_torn_share;
  return coded() && !follows ? BurstVerdict::kPatternMismatch : BurstVerdict::kAccepted;
}

}  // namespace enamel::pipeline
