#include "pipeline/decode/burst_decoder.hpp"

#include <cmath>
#include <string>
#include <utility>

#include "pipeline/decode/pattern_modes.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/decode/steps/burst_output.hpp"
#include "pipeline/decode/steps/relative_regions.hpp"
#include "pipeline/decode/steps/sight.hpp"
#include "pipeline/decode/steps/surface.hpp"

namespace enamel::pipeline {
namespace {

/// chosen: by judgement. Of a depth range at one pixel; probes have about 5.
constexpr double kMostFringes = 100;

/// Largest number of fringes that the depth range spans at a pixel.
double span_fringes(const RayDepth& rays) {
  float most = 0;
  for (std::size_t i = 0; i < rays.phase_near_rad.size(); ++i)
    most = larger(most, std::abs(rays.phase_far_rad[i] - rays.phase_near_rad[i]));
  return static_cast<double>(most / kTwoPiF);
}

Carrier carrier_of(const calib::Rig& rig, const RayDepth& rays, double near_mm, float max_slope_deg) {
  const auto width = static_cast<std::size_t>(rays.width);
  const std::size_t centre = static_cast<std::size_t>(rays.height / 2) * width + width / 2;
  const RaySlopes slopes{static_cast<double>(rays.c0[centre]), static_cast<double>(rays.c1[centre]), 1 / rig.camera.fx,
                         1 / rig.camera.fy};
  return make_carrier(rays.phase_mid_rad.data(), slopes, near_mm, max_slope_deg);
}

PatternOptics optics_of(const calib::Rig& rig) {
  const calib::PatternValues& p = rig.patterns;
  const double focal_px = p.axis_v ? rig.projector.fy : rig.projector.fx;
  PatternOptics out{static_cast<float>(p.amplitude / p.mean), static_cast<float>(p.period_px / focal_px)};
  if (const auto& light = rig.light_inside)
    out.field = ApparentDepthField(light->of_enamel, rig.camera.width, rig.camera.height);
  return out;
}

}  // namespace

/// One burst on its way: what it is, the memory it is worked in, and what becomes of it.
struct BurstDecoder::Burst {
  const BurstView& view;
  const BurstsBefore& before;
  DecodeWorkspace::Steps& steps;
  PatternStrategy::Work& work;
  const StepHook& hook;
  DecodedBurst& out;
  bool& has_surface;  ///< out.reject holds what became of each pixel on the surface
};

Result<BurstDecoder> BurstDecoder::make(const calib::Rig& rig, const DecodeConfig& config) {
  BurstDecoder d;
  ENAMEL_TRY_ASSIGN(PatternCode code, read_pattern_code(rig));
  const auto range = rig.depth_range ? rig.depth_range : config.depth_range_mm;
  if (!range) return fail(ErrorCode::kRigInvalid, "key 'depth_range_mm' is missing and none was given");
  ENAMEL_TRY_ASSIGN(RayDepth rays, RayDepth::bake(rig, *range));
  const double span = span_fringes(rays);
  if (!(span < kMostFringes)) {
    return fail(ErrorCode::kRigInvalid, "key 'depth_range_mm' spans " + std::to_string(static_cast<long long>(span)) +
                                            " fringes at a pixel: the range or 'period_px' is absurd");
  }
  ENAMEL_TRY(check_code_decides(code, rig.patterns, span));
  d.rays_ = std::make_shared<const RayDepth>(std::move(rays));
  d.carrier_ = carrier_of(rig, *d.rays_, range->near_mm, config.links.max_slope_deg);
  d.strategy_ = make_strategy(std::move(code), {d.rays_, d.carrier_}, config);
  d.noise_ = rig.noise;
  d.optics_ = optics_of(rig);
  d.wave_priors_ = priors_of(rig, config.wave);
  d.config_ = config;
  return d;
}

void BurstDecoder::decode(const BurstView& view, DecodeWorkspace& workspace, DecodedBurst& out,
                          const BurstsBefore& before) const {
  const int w = rays_->width, h = rays_->height;
  if (workspace.strategy_ != strategy_) {
    workspace.strategy_ = strategy_;
    workspace.work_ = strategy_->make_work();
  }
  resize_output(w, h, out);
  const bool fits = view.is_consistent() && view.width == w && view.height == h;
  bool has_surface = false;
  out.verdict = fits ? run({view, before, workspace.steps_, *workspace.work_, workspace.on_step, out, has_surface})
                     : BurstVerdict::kFrameMismatch;
  if (out.accepted()) return;
  if (out.verdict != BurstVerdict::kNoCode || !strategy_->tells_unplaced()) out.relative.clear();
  if (!fits) show_nothing(out);
  const bool keeps_rejects = has_surface && out.verdict == BurstVerdict::kTooFewPoints;
  if (fits && !keeps_rejects) show_phase(workspace.steps_.phase, out);
  withdraw_surface(out);
  count_rejects(out);
}

DecodedBurst BurstDecoder::decode(const BurstView& view) const {
  DecodeWorkspace workspace;
  DecodedBurst out;
  decode(view, workspace, out);
  return out;
}

/// The steps, each from what the one before found; the first that finds no sense in the burst ends it.
BurstVerdict BurstDecoder::run(const Burst& burst) const {
  burst.out.diagnostics = {};
  using Step = BurstVerdict (BurstDecoder::*)(const Burst&) const;
  constexpr Step kSteps[] = {&BurstDecoder::find_phase, &BurstDecoder::find_regions, &BurstDecoder::find_orders,
                             &BurstDecoder::find_surface};
  for (const Step step : kSteps) {
    const BurstVerdict verdict = (this->*step)(burst);
    if (verdict != BurstVerdict::kAccepted) return verdict;
  }
  return BurstVerdict::kAccepted;
}

/// Frames to wrapped phase.
BurstVerdict BurstDecoder::find_phase(const Burst& burst) const {
  PhaseMaps& phase = burst.steps.phase;
  DecodeDiagnostics& diagnostics = burst.out.diagnostics;
  diagnostics.noise = noise_ ? noise_from_rig(*noise_, burst.view.bit_depth) : noise_from_closure(burst.view);
  strategy_->solve_phase(burst.view, diagnostics.noise, burst.work, phase);
  copy_images(phase, diagnostics.noise, burst.out);
  burst.out.sight = look_at(diagnostics.noise, phase);
  tell(burst.hook, "phase");
  if (const auto why = too_few_valid(phase, config_.light)) return *why;
  if (!frames_go_together(burst.view, burst.before.views, phase, config_.frames, diagnostics))
    return mismatch(phase, config_.light);
  const std::vector<WavePrior> expected = priors_after(burst.before.wave, wave_priors_, config_.wave);
  strategy_->straighten(expected, burst.work, diagnostics, phase);
  tell(burst.hook, "wave");
  if (diagnostics.wave.is_cosine()) return BurstVerdict::kAccepted;
  return too_few_valid(phase, config_.light).value_or(BurstVerdict::kAccepted);
}

/// Wrapped phase to regions: neighbours that lie on one surface, unwrapped within themselves.
BurstVerdict BurstDecoder::find_regions(const Burst& burst) const {
  PhaseMaps& phase = burst.steps.phase;
  LinkMaps& links = burst.steps.regions.links;
  DecodeDiagnostics& diagnostics = burst.out.diagnostics;
  strategy_->measure_pattern(phase, diagnostics);
  reject_half_lit(phase.modulation_dn, phase.reject);
  compute_links(phase, carrier_, config_.links, links);
  diagnostics.linked_share = linked_share(links);
  strategy_->reject_unsure(burst.work, links, phase.reject);
  reject_edges(links, phase);
  tell(burst.hook, "links");
  if (diagnostics.linked_share < config_.linked.min_linked_share || !strategy_->shows_pattern(diagnostics) ||
      !could_be_projected(diagnostics, config_.wave_shape))
    return contradiction(burst);
  strategy_->unwrap(phase, burst.work, burst.steps.regions);
  tell(burst.hook, "unwrap");
  return BurstVerdict::kAccepted;
}

/// Regions to absolute fringe orders.
BurstVerdict BurstDecoder::find_orders(const Burst& burst) const {
  PhaseMaps& phase = burst.steps.phase;
  FringeOrders& orders = burst.steps.orders;
  DecodeDiagnostics& diagnostics = burst.out.diagnostics;
  strategy_->find_orders(phase, burst.steps.regions, burst.work, diagnostics, orders);
  const double agreement = orders.code_agreement();
  if (agreement >= config_.code.min_agreement && agreement < config_.code.sound_agreement)
    diagnostics.withdrawn_share = withdraw_contradicted(orders, config_.code.sound_agreement);
  find_spans(orders);
  reject_undecided(orders, phase.reject);
  reject_beside_jumps(orders, phase.reject);
  find_relative(orders.segments.segments, orders.orders.segments, config_.order.min_region_px,
                orders.orders.work.parent, burst.out.relative);
  diagnostics.code_agreement = orders.code_agreement();
  diagnostics.torn_share = orders.torn_share();
  tell(burst.hook, "order");
  if (orders.spans.empty()) {
    const BurstVerdict why = strategy_->why_unplaced(phase, burst.work, diagnostics);
    if (why == BurstVerdict::kPatternMismatch) return contradiction(burst);
    if (why == BurstVerdict::kNoCode && strategy_->tells_unplaced()) take_phase(phase, {}, burst.out.relative);
    return why;
  }
  return strategy_->trusts_orders(diagnostics) ? BurstVerdict::kAccepted : contradiction(burst);
}

/// Absolute phase, refined, to the surface.
BurstVerdict BurstDecoder::find_surface(const Burst& burst) const {
  DecodedBurst& out = burst.out;
  PhaseMaps& phase = burst.steps.phase;
  DecodeDiagnostics& diagnostics = out.diagnostics;
  const RefinedPhase refined =
      strategy_->refine(burst.steps.orders, out.relative, burst.work, burst.hook, diagnostics, phase);
  show_anew(refined, diagnostics.noise, out);
  if (has_odd_frame(diagnostics, config_.odd_frame) || !strategy_->explains_frames(diagnostics))
    return mismatch(phase, config_.light);
  if (std::abs(static_cast<double>(diagnostics.motion_rad)) > config_.motion.max_motion_rad)
    return BurstVerdict::kTooFast;
  undo_translucency({*rays_, seen_through(diagnostics.wave, optics_), diagnostics.noise.black_dn}, config_.translucency,
                    refined, out.sight, phase);
  take_phase(phase, diagnostics.ripple, out.relative);
  make_surface(refined, *rays_, diagnostics.ripple, config_.normals, burst.steps.scratch, out);
  burst.has_surface = true;
  tell(burst.hook, "surface");
  count_rejects(out);
  if (out.patch.valid_px >= config_.light.min_points) return BurstVerdict::kAccepted;
  if (may_have_odd_frame(diagnostics, config_.odd_frame)) return mismatch(phase, config_.light);
  return strategy_->tells_unplaced() ? BurstVerdict::kNoCode : BurstVerdict::kTooFewPoints;
}

/// Frames that are not those of a surface at rest: too fast a motion, or the wrong frames. Motion leaves neighbours
/// linked.
BurstVerdict BurstDecoder::contradiction(const Burst& burst) const {
  DecodeDiagnostics& diagnostics = burst.out.diagnostics;
  const PhaseMaps& phase = burst.steps.phase;
  if (diagnostics.linked_share < config_.linked.min_linked_share) return mismatch(phase, config_.light);
  const auto motion_rad = strategy_->fast_motion(phase);
  if (!motion_rad) return mismatch(phase, config_.light);
  diagnostics.motion_rad = *motion_rad;
  return BurstVerdict::kTooFast;
}

}  // namespace enamel::pipeline
