// BurstDecoder's last step before depth: the best phase that all four frames give, less motion and harmonics.
#include "pipeline/decode/decode_buffers.hpp"
#include "pipeline/decode/mode_m/micro_gates.hpp"
#include "pipeline/decode/mode_m/micro_phase.hpp"
#include "pipeline/decode/mode_m/micro_saturated.hpp"
#include "pipeline/decode/mode_m/micro_view.hpp"
#include "pipeline/decode/mode_t/closure_gates.hpp"
#include "pipeline/decode/mode_t/four_step_view.hpp"
#include "pipeline/decode/mode_t/ripple_depth.hpp"
#include "pipeline/decode/motion/motion_detail.hpp"
#include "pipeline/decode/steps/frame_gates.hpp"
#include "pipeline/decode/steps/relative_regions.hpp"
#include "pipeline/decode/steps/surface.hpp"

namespace enamel::pipeline {
namespace {

/// Whether a rigid motion of the burst is asked for. Blocks: ClosureFit or MicroMotion.
template <class Blocks>
bool shows_motion(const Blocks& blocks, const DecodeConfig& config) {
  return config.motion_passes > 0 &&
         !stands_still(blocks.block_motion_rad, blocks.block_sigma_rad, config.rigid.negligible_rad);
}

}  // namespace

// Motion and harmonics, first per block of the image, then, where the probe moved, as one rigid motion of the surface
// that the first correction shows.
template <class Step>
void BurstDecoder::undo_errors(DecodeWorkspace::Buffers& b, DecodeDiagnostics& diag, const Step& step) const {
  const float black = diag.noise.black_dn;
  if (config_.correct_closure) {
    fit_closure(b.phase, b.polarity, diag.noise, config_.closure, b.closure);
    diag.motion_rad = b.closure.motion_rad;
    diag.harmonic = b.closure.harmonic;
    step("closure");
    if (shows_motion(b.closure, config_)) {
      FourStepView view({b.phase, b.polarity, b.closure, *rays_, black, config_.rigid.max_residual}, b.view_pixels);
      diag.rigid = fit_rigid_motion(view, b.phase, b.polarity.turn, *rays_, config_.motion_passes, config_.rigid,
                                    b.rigid, b.field);
      if (diag.rigid.moved && config_.rigid.dense)
        refine_motion(diag.rigid, b.rigid.images, *rays_, b.rigid.detail, b.field);
      if (diag.rigid.moved) diag.harmonic = b.field.shared;
    }
    const BurstErrors errors = diag.rigid.moved ? errors_of(b.field) : b.closure.errors();
    // Each block's own harmonic takes up what its light leaves, which an odd frame would be taken for.
    const BurstErrors of_blocks{errors.motion_rad, b.closure.errors().harmonic, errors.light, {}, {}};
    const OddFrame odd = find_odd_frame(b.phase, b.polarity, of_blocks, black, b.closure.block_px);
    diag.odd_shift_rad = odd.shift_rad;
    diag.unrest = odd.unrest;
    fit_flip_blur(b.phase, b.polarity, errors, black, config_.polarity, config_.flips, b.flips);
    diag.flip_blur_rad = b.flips.burst_rad;
    correct_saturated(b.saturated, b.polarity, errors, black, b.phase, b.scratch);
    b.torn.start(b.spans, b.saturated, config_.torn, config_.phase, b.phase.reject.width(), b.phase.reject.height());
    const MovedBurst moved{b.misfit, b.torn, signs_};
    finish_phase(b.flips, errors, black, diag.noise, config_.flips, b.phase, b.polarity,
                 diag.rigid.moved ? &moved : nullptr);
    for (std::size_t k = 0; k < b.saturated.size(); ++k) b.phase.phase_rad[b.saturated[k].index] = b.scratch[k];
    step("motion");
  }
  if (config_.correct_ripple) {
    const PhaseMoments moments = phase_moments(b.spans, b.phase);
    diag.ripple = shrink(level(moments), moments);
    const DepthRipple by_depth = level_by_depth(b.spans, b.phase, *rays_, moments, diag.ripple);
    correct_by_depth(by_depth, b.polarity.turn, *rays_, b.phase);
    diag.ripple_by_depth_rad = by_depth.rms_rad();
  }
}

/// Best phase now that orders are known, in place; returns its turns. Mode M's phase is final but for its ripple.
const Map<std::int16_t>& BurstDecoder::refine(DecodeWorkspace& workspace, DecodedBurst& out) const {
  auto& b = *workspace.buffers_;
  DecodeDiagnostics& diag = out.diagnostics;
  const auto step = [&](const char* name) {
    if (workspace.on_step) workspace.on_step(name);
  };
  // What is shown of pixels solved from other frames than at first.
  const auto show_anew = [&](const std::vector<std::size_t>& pixels) {
    for (const std::size_t i : pixels) {
      out.patch.texture_dn[i] = b.phase.mean_dn[i] - diag.noise.black_dn;
      out.patch.modulation_dn[i] = b.phase.modulation_dn[i];
    }
  };
  if (micro_) {
    cells_of(out.relative, b.relative_cells);
    place_spans(b.spans, b.relative_cells, b.phase.phase_rad.width(), b.phase.phase_rad.height(), b.polarity.turn);
    if (config_.correct_ripple) {
      diag.third_rad = estimate_third_harmonic(b.spans, b.phase).a1_rad;
      correct_third_harmonic(b.polarity.turn, diag.third_rad, b.phase);
    }
    step("harmonic");
    if (!config_.correct_closure) return b.polarity.turn;
    const auto& turn = b.polarity.turn;
    fit_micro_motion(turn, *micro_, diag.third_rad, diag.noise, config_.micro_refit, b.phase, b.micro_motion);
    diag.motion_rad = b.micro_motion.motion_rad;
    if (shows_motion(b.micro_motion, config_)) {
      MicroView view(
          {turn, turn, 0, *micro_, diag.third_rad, b.phase, *rays_, b.micro_motion, config_.rigid.max_residual, true});
      diag.rigid =
          fit_rigid_motion(view, b.phase, turn, *rays_, config_.motion_passes, config_.rigid, b.rigid, b.field);
      if (diag.rigid.moved) {
        b.micro_motion.surface = surface_motion(b.field);
        refit_micro_gain(turn, *micro_, diag.third_rad, diag.noise, config_.micro_refit, b.phase, b.micro_motion);
      }
    }
    const MicroOdd odd = find_micro_odd(turn, *micro_, b.micro_motion, diag.third_rad, diag.noise,
                                        config_.micro_refit.max_residual, b.phase);
    diag.code_shift_rad = odd.code_shift_rad, diag.odd_shift_rad = odd.odd_shift_rad, diag.unrest = odd.unrest;
    diag.closure_share = odd.explained_share;
    step("motion");
    undo_micro_motion(turn, b.micro_motion, b.phase);
    join_code_frame(b.spans, turn, *micro_, b.micro_motion, diag.third_rad, diag.noise, config_.micro_refit, b.phase,
                    b.strips, diag.rigid.moved ? &b.misfit : nullptr);
    solve_micro_saturated({b.spans, *micro_, b.micro_motion, diag.third_rad, diag.noise, rays_->phase_mid_rad.data()},
                          config_.phase, b.phase, b.polarity.turn, b.filled);
    show_anew(b.filled);
    step("refit");
    return b.polarity.turn;
  }
  apply_polarity(b.spans, signs_, diag.noise, config_.polarity, b.phase, b.polarity);
  sort_out_saturated(b.saturated, signs_, diag.noise, config_.polarity, b.polarity.turn, b.phase);
  step("polarity");
  undo_errors(b, diag, step);
  if (diag.rigid.moved) show_anew(b.torn.regained());
  return b.polarity.turn;
}

}  // namespace enamel::pipeline
