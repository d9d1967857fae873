#include "pipeline/algo/decode/burst_decoder.hpp"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "pipeline/algo/decode/burst_gates.hpp"
#include "pipeline/algo/decode/surface.hpp"
#include "pipeline/algo/phase/micro_phase.hpp"
#include "pipeline/algo/phase/poly_trig.hpp"
#include "pipeline/algo/phase/saturated.hpp"
#include "pipeline/algo/unwrap/cells.hpp"
#include "pipeline/algo/unwrap/code_steps.hpp"
#include "pipeline/algo/unwrap/flood.hpp"
#include "pipeline/algo/unwrap/micro_evidence.hpp"
#include "pipeline/algo/unwrap/polarity_evidence.hpp"

namespace enamel::algo {
namespace {

constexpr double kMostFringes = 100;  ///< of a depth range at one pixel; probes have about 5
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

void resize_output(int w, int h, DecodedBurst& out) {
  if (out.phase_rad.width() == w && out.phase_rad.height() == h) return;
  for (Map<float>* m :
       {&out.phase_rad, &out.patch.depth_mm, &out.patch.sigma_mm, &out.patch.texture_dn, &out.patch.modulation_dn})
    *m = Map<float>(w, h);
  out.order = Map<std::uint8_t>(w, h);
  out.reject = Map<PixelReject>(w, h);
  out.patch.points = out.patch.normals = Map<Vec3f>(w, h, Vec3f::Constant(kNan));
}

void clear_surface(DecodedBurst& out) {
  for (Map<float>* m : {&out.patch.depth_mm, &out.patch.sigma_mm})
    std::fill(m->pixels().begin(), m->pixels().end(), kNan);
  for (Map<Vec3f>* m : {&out.patch.points, &out.patch.normals})
    std::fill(m->pixels().begin(), m->pixels().end(), Vec3f::Constant(kNan));
  std::fill(out.order.pixels().begin(), out.order.pixels().end(), kNoOrder);
}

void count_rejects(DecodedBurst& out) {
  out.counts.fill(0);
  for (const PixelReject r : out.reject.pixels()) ++out.counts[static_cast<std::size_t>(r)];
  out.patch.valid_px = out.counts[static_cast<std::size_t>(PixelReject::kNone)];
}

std::size_t count_of(const PhaseMaps& maps, PixelReject reason) {
  return static_cast<std::size_t>(std::count(maps.reject.pixels().begin(), maps.reject.pixels().end(), reason));
}

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

/// Grey image, modulation and wrapped phase: what is worth showing whatever becomes of the burst.
void copy_images(const PhaseMaps& maps, const NoiseModel& noise, DecodedBurst& out) {
  for (std::size_t i = 0; i < maps.mean_dn.size(); ++i) {
    out.patch.texture_dn[i] = maps.mean_dn[i] - noise.black_dn;
    out.patch.modulation_dn[i] = maps.modulation_dn[i];
  }
}

/// Largest number of fringes that the depth range spans at a pixel.
double span_fringes(const RayDepth& rays) {
  float most = 0;
  for (std::size_t i = 0; i < rays.phase_near_rad.size(); ++i)
    most = larger(most, std::abs(rays.phase_far_rad[i] - rays.phase_near_rad[i]));
  return static_cast<double>(most / kTwoPiF);
}

/// Where no cell was decided the three-frame phase stands; unlit and noisy pixels have none.
void finish_phase(const PhaseMaps& maps, bool with_cells, DecodedBurst& out) {
  for (std::size_t i = 0; i < maps.phase_rad.size(); ++i) {
    const PixelReject r = out.reject[i];
    const bool none = (r == PixelReject::kDark) | (r == PixelReject::kSaturated) | (r == PixelReject::kNoisy);
    const bool solved = with_cells && ((r == PixelReject::kNone) | (r == PixelReject::kOutOfRange));
    const float raw = solved ? out.phase_rad[i] : maps.phase_rad[i];
    out.phase_rad[i] = none ? kNan : (raw >= kPiF ? -kPiF : raw);
  }
}

}  // namespace

struct DecodeWorkspace::Buffers {
  PhaseMaps phase;
  LinkMaps links;
  FloodMaps flood;
  CodeSteps steps;  ///< of mode M
  PieceList pieces;
  PolarityEvidence polarity_evidence;
  MicroEvidence micro_evidence;
  OrderResult orders;
  std::vector<CellSpan> spans;
  PolarityMaps polarity;
  ClosureFit closure;
  RigidMotionWork rigid;
  MotionField field;
  MicroMotion micro_motion;
  Map<float> raw_phase;
  std::vector<SaturatedPixel> saturated;  ///< solved without their saturated frame
  Map<float> inverse_depth;
  std::vector<float> scratch;
};

DecodeWorkspace::DecodeWorkspace() : buffers_(std::make_unique<Buffers>()) {}
DecodeWorkspace::~DecodeWorkspace() = default;
DecodeWorkspace::DecodeWorkspace(DecodeWorkspace&&) noexcept = default;
DecodeWorkspace& DecodeWorkspace::operator=(DecodeWorkspace&&) noexcept = default;

Result<BurstDecoder> BurstDecoder::make(const calib::Rig& rig, const DecodeConfig& config) {
  BurstDecoder d;
  const bool micro = rig.patterns.mode == calib::PatternMode::kMicro;
  if (micro) {
    ENAMEL_TRY_ASSIGN(d.micro_, make_micro_code(rig.patterns, rig.projector));
    if (!rig.noise)
      return fail(ErrorCode::kRigInvalid, "key 'noise' is missing, and mode M cannot tell it from a burst");
  } else {
    ENAMEL_TRY_ASSIGN(d.signs_, make_cell_signs(rig.patterns, rig.projector));
  }
  const auto range = rig.depth_range ? rig.depth_range : config.depth_range_mm;
  if (!range) return fail(ErrorCode::kRigInvalid, "key 'depth_range_mm' is missing and none was given");
  ENAMEL_TRY_ASSIGN(RayDepth rays, RayDepth::bake(rig, *range));
  const double span = span_fringes(rays);
  if (!(span < kMostFringes)) {
    return fail(ErrorCode::kRigInvalid, "key 'depth_range_mm' spans " + std::to_string(static_cast<long long>(span)) +
                                            " fringes at a pixel: the range or 'period_px' is absurd");
  }
  if (micro) ENAMEL_TRY(check_orders_differ(rig.patterns.code_ratio, span));
  if (rig.patterns.mode == calib::PatternMode::kPolarity) ENAMEL_TRY(check_windows_differ(d.signs_, span));
  d.rays_ = std::make_shared<const RayDepth>(std::move(rays));
  const RayDepth& r = *d.rays_;
  const auto width = static_cast<std::size_t>(r.width);
  const std::size_t centre = static_cast<std::size_t>(r.height / 2) * width + width / 2;
  const RaySlopes slopes{static_cast<double>(r.c0[centre]), static_cast<double>(r.c1[centre]), 1 / rig.camera.fx,
                         1 / rig.camera.fy};
  d.carrier_ = make_carrier(r.phase_mid_rad.data(), slopes, range->near_mm, config.links.max_slope_deg);
  d.noise_ = rig.noise;
  d.config_ = config;
  return d;
}

// Motion and harmonics, first per block of the image, then, where the probe moved, as one rigid motion of the surface
// that the first correction shows.
template <class Step>
void BurstDecoder::undo_errors(DecodeWorkspace::Buffers& b, DecodeDiagnostics& diag, const Step& step) const {
  const float black = diag.noise.black_dn;
  if (config_.correct_closure) {
    b.raw_phase = b.phase.phase_rad;
    fit_closure(b.phase, b.polarity, config_.closure, b.closure);
    correct_phase(b.polarity, nullptr, black, b.closure, b.phase);
    diag.motion_rad = b.closure.motion_rad;
    diag.harmonic = b.closure.harmonic;
    step("closure");
    const MotionField* field = nullptr;
    const int passes = stands_still(b.closure, config_.rigid) ? 0 : config_.motion_passes;
    for (int pass = 0; pass < passes; ++pass) {
      make_inverse_depth(b.phase, b.polarity.turn, *rays_, b.inverse_depth);
      diag.rigid = fit_rigid_motion(b.phase, b.polarity, b.closure, *rays_, b.inverse_depth, black, pass > 0,
                                    config_.rigid, b.rigid, b.field);
      if (!diag.rigid.moved) break;
      b.phase.phase_rad = b.raw_phase;
      correct_phase(b.polarity, &b.field, black, b.closure, b.phase);
      field = &b.field;
    }
    const OddFrame odd = find_odd_frame(b.phase, b.polarity, b.closure, field);
    diag.odd_shift_rad = odd.shift_rad;
    diag.unrest = odd.unrest;
    const Map<float>& motion = field != nullptr ? field->rate_rad : b.closure.pixel_motion_rad;
    correct_saturated(b.saturated, b.raw_phase, motion, b.closure.pixel_harmonic, b.phase);
    step("motion");
  }
  if (config_.correct_ripple) {
    const PhaseMoments moments = phase_moments(b.spans, b.phase);
    diag.ripple = shrink(level(moments), moments);
  }
}

void BurstDecoder::solve_phase(const BurstView& view, DecodeWorkspace& workspace, DecodedBurst& out) const {
  PhaseMaps& maps = workspace.buffers_->phase;
  NoiseModel& noise = out.diagnostics.noise;
  noise = noise_ ? noise_from_rig(*noise_, view.bit_depth) : noise_from_closure(view);
  auto& saturated = workspace.buffers_->saturated;
  saturated.clear();
  (micro_ ? compute_micro_phase : compute_phase)(view, noise, config_.phase, maps);
  if (!micro_) solve_saturated(view, noise, config_.phase, maps, saturated);
  copy_images(maps, noise, out);
}

bool BurstDecoder::looks_like_fringes(DecodeWorkspace& workspace, DecodeDiagnostics& diag) const {
  auto& b = *workspace.buffers_;
  (micro_ ? diag.direction_share : diag.closure_share) =
      micro_ ? direction_share(b.phase, carrier_) : closure_share(b.phase, diag.noise);
  reject_half_lit(b.phase.modulation_dn, b.phase.reject);
  compute_links(b.phase, carrier_, config_.links, b.links);
  diag.linked_share = b.links.pairs > 0 ? static_cast<double>(b.links.linked) / static_cast<double>(b.links.pairs) : 0;
  reject_parted(b.saturated, b.links, b.phase.reject);
  reject_edges(b.links, b.phase);
  if (diag.linked_share < config_.min_linked_share) return false;
  return micro_ ? diag.direction_share >= config_.min_direction_share : diag.closure_share >= config_.min_closure_share;
}

/// Absolute orders of all pieces, and whether the code that they rest on is the rig's.
BurstVerdict BurstDecoder::place(DecodeWorkspace& workspace, DecodeDiagnostics& diag) const {
  auto& b = *workspace.buffers_;
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

/// Best phase now that orders are known, in place; returns its turns. Mode M's phase is final but for its ripple.
const Map<std::int16_t>& BurstDecoder::refine(DecodeWorkspace& workspace, DecodeDiagnostics& diag) const {
  auto& b = *workspace.buffers_;
  const auto step = [&](const char* name) {
    if (workspace.on_step) workspace.on_step(name);
  };
  if (micro_) {
    place_spans(b.spans, b.phase.phase_rad.width(), b.phase.phase_rad.height(), b.polarity.turn);
    if (config_.correct_ripple) {
      diag.third_rad = estimate_third_harmonic(b.spans, b.phase).a1_rad;
      correct_third_harmonic(b.spans, diag.third_rad, b.phase);
    }
    step("harmonic");
    if (!config_.correct_closure) return b.polarity.turn;
    const auto& turn = b.polarity.turn;
    fit_micro_motion(b.spans, turn, *micro_, diag.third_rad, diag.noise, config_.micro_refit, b.phase, b.micro_motion);
    diag.motion_rad = b.micro_motion.motion_rad;
    step("motion");
    undo_micro_motion(b.spans, turn, *micro_, b.micro_motion, b.phase);
    join_code_frame(b.spans, turn, *micro_, b.micro_motion, diag.third_rad, diag.noise, config_.micro_refit, b.phase);
    step("refit");
    return b.polarity.turn;
  }
  apply_polarity(b.spans, signs_, diag.noise, config_.polarity, b.phase, b.polarity);
  sort_out_saturated(b.saturated, signs_, diag.noise, config_.polarity, b.polarity.turn, b.phase);
  step("polarity");
  undo_errors(b, diag, step);
  return b.polarity.turn;
}

BurstVerdict BurstDecoder::run(const BurstView& view, DecodeWorkspace& workspace, DecodedBurst& out) const {
  auto& b = *workspace.buffers_;
  const auto step = [&](const char* name) {
    if (workspace.on_step) workspace.on_step(name);
  };
  auto& diag = out.diagnostics;
  diag = {};
  solve_phase(view, workspace, out);
  step("phase");
  if (count_of(b.phase, PixelReject::kNone) < config_.min_points) {
    const bool bright = count_of(b.phase, PixelReject::kSaturated) >= config_.min_points;
    const bool lit = count_of(b.phase, PixelReject::kNoisy) > count_of(b.phase, PixelReject::kDark);
    return bright ? BurstVerdict::kSaturated : (lit ? BurstVerdict::kNoFringes : BurstVerdict::kTooDark);
  }
  diag.repeated_share = repeated_share(view, b.phase, diag.noise);
  if (diag.repeated_share > config_.max_repeated_share) return BurstVerdict::kPatternMismatch;
  const bool fringes = looks_like_fringes(workspace, diag);
  step("links");
  if (!fringes) return BurstVerdict::kPatternMismatch;
  flood(b.phase.phase_rad, b.links, b.flood);
  step("unwrap");
  const BurstVerdict placed = place(workspace, diag);
  step("order");
  if (placed != BurstVerdict::kAccepted) return placed;
  const Map<std::int16_t>& turn = refine(workspace, diag);
  if (diag.odd_shift_rad > config_.max_odd_shift_rad && diag.odd_shift_rad > config_.max_odd_over_unrest * diag.unrest)
    return BurstVerdict::kPatternMismatch;
  out.reject = b.phase.reject;
  make_surface(b.phase, turn, *rays_, diag.ripple, b.inverse_depth, out);
  step("triangulate");
  compute_normals(*rays_, b.inverse_depth, out.patch.sigma_mm, config_.normals, b.scratch, out.patch.normals);
  step("normals");
  const auto points =
      static_cast<std::size_t>(std::count(out.reject.pixels().begin(), out.reject.pixels().end(), PixelReject::kNone));
  return points < config_.min_points ? BurstVerdict::kTooFewPoints : BurstVerdict::kAccepted;
}

void BurstDecoder::decode(const BurstView& view, DecodeWorkspace& workspace, DecodedBurst& out) const {
  const int w = rays_->width, h = rays_->height;
  auto& b = *workspace.buffers_;
  resize_output(w, h, out);
  if (b.inverse_depth.width() != w || b.inverse_depth.height() != h) b.inverse_depth = Map<float>(w, h);
  const bool fits = view.is_consistent() && view.width == w && view.height == h;
  out.verdict = fits ? run(view, workspace, out) : BurstVerdict::kFrameMismatch;
  const bool reached_surface = out.verdict == BurstVerdict::kAccepted || out.verdict == BurstVerdict::kTooFewPoints;
  if (!fits) {
    std::fill(out.reject.pixels().begin(), out.reject.pixels().end(), PixelReject::kDark);
    for (Map<float>* m : {&out.phase_rad, &out.patch.texture_dn, &out.patch.modulation_dn})
      std::fill(m->pixels().begin(), m->pixels().end(), kNan);
  } else {
    if (!reached_surface) out.reject = b.phase.reject;
    finish_phase(b.phase, reached_surface, out);
  }
  if (!out.accepted()) {
    clear_surface(out);
    for (PixelReject& r : out.reject.pixels()) r = r == PixelReject::kNone ? PixelReject::kRelative : r;
  }
  count_rejects(out);
}

DecodedBurst BurstDecoder::decode(const BurstView& view) const {
  DecodeWorkspace workspace;
  DecodedBurst out;
  decode(view, workspace, out);
  return out;
}

}  // namespace enamel::algo
