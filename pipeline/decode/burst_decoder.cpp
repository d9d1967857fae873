#include "pipeline/decode/burst_decoder.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pipeline/decode/decode_buffers.hpp"
#include "pipeline/decode/mode_m/micro_gates.hpp"
#include "pipeline/decode/mode_t/closure_gates.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/decode/steps/burst_output.hpp"
#include "pipeline/decode/steps/frame_gates.hpp"
#include "pipeline/decode/steps/relative_regions.hpp"
#include "pipeline/decode/steps/surface.hpp"

namespace enamel::pipeline {
namespace {

constexpr double kMostFringes = 100;  ///< of a depth range at one pixel; probes have about 5

/// Largest number of fringes that the depth range spans at a pixel.
double span_fringes(const RayDepth& rays) {
  float most = 0;
  for (std::size_t i = 0; i < rays.phase_near_rad.size(); ++i)
    most = larger(most, std::abs(rays.phase_far_rad[i] - rays.phase_near_rad[i]));
  return static_cast<double>(most / kTwoPiF);
}

}  // namespace

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

/// Why so few pixels are left that nothing can be decoded.
BurstVerdict BurstDecoder::too_few_valid(const PhaseMaps& maps) const {
  const std::size_t saturated = count_of(maps, PixelReject::kSaturated), dark = count_of(maps, PixelReject::kDark),
                    noisy = count_of(maps, PixelReject::kNoisy);
  if (count_of(maps, PixelReject::kNone) > saturated + dark + noisy) return BurstVerdict::kTooFewPoints;
  if (saturated >= config_.min_points || saturated > dark + noisy) return BurstVerdict::kSaturated;
  return noisy > dark ? BurstVerdict::kNoFringes : BurstVerdict::kTooDark;
}

BurstVerdict BurstDecoder::run(const BurstView& view, std::span<const BurstView> before, DecodeWorkspace& workspace,
                               DecodedBurst& out) const {
  auto& b = *workspace.buffers_;
  const auto step = [&](const char* name) {
    if (workspace.on_step) workspace.on_step(name);
  };
  auto& diag = out.diagnostics;
  diag = {};
  solve_phase(view, workspace, out);
  step("phase");
  if (count_of(b.phase, PixelReject::kNone) < config_.min_points) return too_few_valid(b.phase);
  const bool stale = std::ranges::any_of(before, [&](const BurstView& was) { return has_stale_frame(view, was); });
  if (stale || has_blank_frame(view, b.phase, diag.noise)) return mismatch(b.phase);
  diag.repeated_share = repeated_share(view, b.phase, diag.noise);
  if (diag.repeated_share > config_.max_repeated_share) return mismatch(b.phase);
  const bool fringes = looks_like_fringes(workspace, diag);
  step("links");
  if (!fringes) return mismatch_or_too_fast(b, diag);
  unwrap(b);
  step("unwrap");
  const BurstVerdict placed = place(workspace, out);
  step("order");
  if (placed == BurstVerdict::kPatternMismatch) return mismatch_or_too_fast(b, diag);
  if (placed != BurstVerdict::kAccepted) {
    if (placed == BurstVerdict::kNoCode && !coded()) take_phase(b.phase, {}, out.relative);
    return placed;
  }
  const Map<std::int16_t>& turn = refine(workspace, out);
  const bool odd =
      diag.odd_shift_rad > config_.max_odd_shift_rad && diag.odd_shift_rad > config_.max_odd_over_unrest * diag.unrest;
  const bool unexplained = micro_ && config_.correct_closure && diag.closure_share < config_.min_closure_share;
  if (odd || unexplained) return mismatch(b.phase);
  if (std::abs(static_cast<double>(diag.motion_rad)) > config_.max_motion_rad) return BurstVerdict::kTooFast;
  take_phase(b.phase, diag.ripple, out.relative);
  make_surface(b.phase, turn, *rays_, diag.ripple, config_.normals, b.scratch, out);
  step("surface");
  count_rejects(out);
  return out.patch.valid_px < config_.min_points ? BurstVerdict::kTooFewPoints : BurstVerdict::kAccepted;
}

void BurstDecoder::decode(const BurstView& view, DecodeWorkspace& workspace, DecodedBurst& out,
                          std::span<const BurstView> before) const {
  const int w = rays_->width, h = rays_->height;
  auto& b = *workspace.buffers_;
  resize_output(w, h, out);
  const bool fits = view.is_consistent() && view.width == w && view.height == h;
  out.verdict = fits ? run(view, before, workspace, out) : BurstVerdict::kFrameMismatch;
  if (out.accepted()) return;
  const bool hangs_together = out.verdict == BurstVerdict::kNoCode && !coded();  // all that such a pattern can tell
  if (!hangs_together) out.relative.clear();
  if (!fits) show_nothing(out);
  if (fits && out.verdict != BurstVerdict::kTooFewPoints) show_phase(b.phase, out);
  withdraw_surface(out);
  count_rejects(out);
}

DecodedBurst BurstDecoder::decode(const BurstView& view) const {
  DecodeWorkspace workspace;
  DecodedBurst out;
  decode(view, workspace, out);
  return out;
}

}  // namespace enamel::pipeline
