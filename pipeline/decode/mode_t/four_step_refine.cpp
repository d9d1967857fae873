// Mode T's best phase: frame 3 joins once its sign is known, then motion, flips and harmonics are undone.
#include "pipeline/decode/mode_t/closure_gates.hpp"
#include "pipeline/decode/mode_t/four_step_light.hpp"
#include "pipeline/decode/mode_t/four_step_memory.hpp"
#include "pipeline/decode/mode_t/ripple_depth.hpp"
#include "pipeline/decode/phase/chosen.hpp"
#include "pipeline/decode/phase/median.hpp"
#include "pipeline/decode/steps/lamp_passes.hpp"

namespace enamel::pipeline {

/// Of the blocks that fit_closure found; where the probe moved, one rigid motion of the surface that they show.
void FourStepMode::find_motion(const PhaseMaps& phase, Memory& m, DecodeDiagnostics& diagnostics) const {
  diagnostics.motion_rad = m.closure.motion_rad;
  diagnostics.harmonic = m.closure.harmonic;
  diagnostics.motion_spread_rad = root_mean_square(m.closure.block_motion_rad);
  diagnostics.rigid = {};
  if (!shows_motion(m.closure.block_motion_rad, m.closure.block_sigma_rad, common_.rigid)) return;
  FourStepView view(
      {phase, m.polarity, m.closure, *geometry_.rays, diagnostics.noise.black_dn, common_.rigid.max_residual},
      m.pixels);
  diagnostics.rigid =
      fit_rigid_motion(view, {phase, m.polarity.wraps, *geometry_.rays}, common_.rigid, m.rigid, m.field);
  if (!diagnostics.rigid.moved) return;
  if (common_.rigid.dense) refine_motion(diagnostics.rigid, m.rigid.images, *geometry_.rays, m.rigid.detail, m.field);
  diagnostics.harmonic = m.field.shared;
}

void FourStepMode::undo_light(const FringeOrders& orders, Memory& m, DecodeDiagnostics& diagnostics,
                              PhaseMaps& phase) const {
  const float black_dn = diagnostics.noise.black_dn;
  const auto find = [&](LampLight of) {
    return find_four_step_light(
        {phase, m.polarity, m.errors(diagnostics.rigid.moved), black_dn},
        {diagnostics.noise, config_.closure.max_residual, diagnostics.motion_rad, common_.light_change, of}, m.light);
  };
  const auto take_off = [&] {
    take_off_light(m.light, orders.spans, m.polarity, black_dn, phase);
    apply_polarity(orders.spans, signs_, diagnostics.noise, config_.polarity, phase, m.polarity);
    sort_out_saturated(m.saturated, signs_, diagnostics.noise, config_.polarity, m.polarity.wraps, phase);
    fit_closure(phase, m.polarity, diagnostics.noise, config_.closure, m.closure);
    find_motion(phase, m, diagnostics);
  };
  undo_lamp(m.light, find, take_off, diagnostics);
}

void FourStepMode::tell_odd_frame(const PhaseMaps& phase, const Memory& m, DecodeDiagnostics& diagnostics) const {
  const BurstErrors errors = m.errors(diagnostics.rigid.moved);
  // Each block's own harmonic takes up what its light leaves, which an odd frame would be taken for.
  const BurstErrors of_blocks{errors.motion_rad, m.closure.errors().harmonic, errors.light, {}, {}};
  const OddFrame odd =
      find_odd_frame({phase, m.polarity, of_blocks, diagnostics.noise.black_dn}, diagnostics.noise, m.closure.block_px);
  diagnostics.odd_sigma_rad = odd.sigma_rad;
  diagnostics.exposure_step = odd.exposure_step;
  diagnostics.odd_shift_rad = odd.shift_rad;
  diagnostics.unrest = odd.unrest;
  diagnostics.odd_blocks = odd.blocks;
}

void FourStepMode::undo_motion(const FringeOrders& orders, Memory& m, DecodeDiagnostics& diagnostics,
                               PhaseMaps& phase) const {
  const float black_dn = diagnostics.noise.black_dn;
  const bool moved = diagnostics.rigid.moved;
  const BurstErrors errors = m.errors(moved);
  fit_flip_blur({phase, m.polarity, errors, black_dn}, config_.polarity, config_.flips, m.flips);
  diagnostics.flip_blur_rad = m.flips.burst_rad;
  correct_saturated(m.saturated, m.polarity, errors, black_dn, phase, m.saturated_rad);
  m.torn.start(orders.spans, m.saturated, config_.torn, common_.phase, phase.reject.width(), phase.reject.height());
  const MovedBurst asked{m.misfit, m.torn, signs_};
  finish_phase({m.flips, errors, diagnostics.noise, config_.flips}, phase, m.polarity, moved ? &asked : nullptr);
  for (std::size_t k = 0; k < m.saturated.size(); ++k) phase.phase_rad[m.saturated[k].index] = m.saturated_rad[k];
}

void FourStepMode::undo_ripple(const FringeOrders& orders, Memory& m, DecodeDiagnostics& diagnostics,
                               PhaseMaps& phase) const {
  const RayDepth& rays = *geometry_.rays;
  const PhaseMoments moments = phase_moments(orders.spans, phase);
  diagnostics.ripple = shrink(level(moments), moments);
  const DepthRipple by_depth = level_by_depth(orders.spans, phase, rays, moments, diagnostics.ripple);
  correct_by_depth(by_depth, m.polarity.wraps, rays, phase);
  diagnostics.ripple_by_depth_rad = by_depth.rms_rad();
}

/// The motion was found through the harmonics, and the harmonics through the motion: each once more. What is left of
/// the second harmonic the closure tells.
void FourStepMode::undo_wave(const FringeOrders& orders, Memory& m, DecodeDiagnostics& diagnostics,
                             PhaseMaps& phase) const {
  const float black_dn = diagnostics.noise.black_dn;
  for (int pass = 0; pass == 0 || (pass < kWavePasses && diagnostics.rigid.moved); ++pass) {
    const BurstErrors errors = m.errors(diagnostics.rigid.moved);
    correct_phase(m.polarity, errors, black_dn, phase);
    diagnostics.wave.harmonic[0] += static_cast<double>(diagnostics.harmonic);
    take_off_harmonics({orders.spans, signs_, m.raw, diagnostics.wave}, m.polarity, errors, black_dn, phase);
    apply_polarity(orders.spans, signs_, diagnostics.noise, config_.polarity, phase, m.polarity);
    fit_closure(phase, m.polarity, diagnostics.noise, config_.closure, m.closure);
    find_motion(phase, m, diagnostics);
  }
  diagnostics.wave_shown = diagnostics.wave;
}

RefinedPhase FourStepMode::refine(const FringeOrders& orders, const RelativeSurface&, Work& work, const StepHook& hook,
                                  DecodeDiagnostics& diagnostics, PhaseMaps& phase) const {
  Memory& m = memory_of(work);
  apply_polarity(orders.spans, signs_, diagnostics.noise, config_.polarity, phase, m.polarity);
  sort_out_saturated(m.saturated, signs_, diagnostics.noise, config_.polarity, m.polarity.wraps, phase);
  tell(hook, "polarity");
  if (common_.correct_closure) {
    fit_closure(phase, m.polarity, diagnostics.noise, config_.closure, m.closure);
    tell(hook, "closure");
    find_motion(phase, m, diagnostics);
    if (diagnostics.wave.is_cosine()) {
      // Before light is taken off: a frame of another moment looks like a lamp that swung.
      tell_odd_frame(phase, m, diagnostics);
      undo_light(orders, m, diagnostics, phase);
    } else {
      undo_wave(orders, m, diagnostics, phase);
      tell_odd_frame(phase, m, diagnostics);
    }
    tell(hook, "light");
    undo_motion(orders, m, diagnostics, phase);
    // Last, because frames that join beside a flip make their sigma anew.
    if (!diagnostics.wave.is_cosine()) widen_by_wave(orders.spans, signs_, diagnostics.wave, common_.phase, phase);
    tell(hook, "motion");
  }
  if (common_.correct_ripple) undo_ripple(orders, m, diagnostics, phase);
  RefinedPhase out{phase, m.polarity.wraps, {}};
  if (diagnostics.rigid.moved) out.solved_anew = m.torn.regained();
  return out;
}

}  // namespace enamel::pipeline
