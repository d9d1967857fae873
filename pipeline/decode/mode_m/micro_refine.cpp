// Mode M's best phase: harmonic and motion undone, then the code frame joins as a fourth measurement.
#include "pipeline/decode/mode_m/micro_gates.hpp"
#include "pipeline/decode/mode_m/micro_join.hpp"
#include "pipeline/decode/mode_m/micro_light.hpp"
#include "pipeline/decode/mode_m/micro_memory.hpp"
#include "pipeline/decode/mode_m/micro_phase.hpp"
#include "pipeline/decode/mode_m/micro_saturated.hpp"
#include "pipeline/decode/mode_m/micro_view.hpp"
#include "pipeline/decode/phase/chosen.hpp"
#include "pipeline/decode/steps/lamp_passes.hpp"
#include "pipeline/decode/steps/relative_regions.hpp"

namespace enamel::pipeline {

/// Per block of the image; where the probe moved, as one rigid motion of the whole surface.
void MicroMode::find_motion(const PhaseMaps& phase, Memory& m, DecodeDiagnostics& diagnostics) const {
  const RayDepth& rays = *geometry_.rays;
  const MicroBurst burst{phase, m.wraps, code_, diagnostics.third_rad, diagnostics.noise};
  fit_micro_motion(burst, config_.refit, m.motion);
  diagnostics.motion_rad = m.motion.motion_rad;
  diagnostics.rigid = {};
  if (shows_motion(m.motion.block_motion_rad, m.motion.block_sigma_rad, common_.rigid)) {
    MicroView view(
        {m.wraps, m.wraps, 0, code_, diagnostics.third_rad, phase, rays, m.motion, common_.rigid.max_residual, true});
    diagnostics.rigid = fit_rigid_motion(view, {phase, m.wraps, rays}, common_.rigid, m.rigid, m.field);
    if (diagnostics.rigid.moved) {
      m.motion.surface = surface_motion(m.field);
      refit_micro_gain(burst, config_.refit, m.motion);
    }
  }
  const MicroOdd odd = find_micro_odd(burst, m.motion, config_.refit.max_residual);
  diagnostics.code_shift_rad = odd.code_shift_rad;
  diagnostics.odd_shift_rad = odd.odd_shift_rad;
  diagnostics.unrest = odd.unrest;
  diagnostics.exposure_step = odd.exposure_step;
  diagnostics.odd_share = odd.odd_share;
  diagnostics.closure_share = odd.explained_share;
}

/// The motion was found through the harmonics, and the harmonics through the motion: each once more.
void MicroMode::undo_wave(Memory& m, DecodeDiagnostics& diagnostics, PhaseMaps& phase) const {
  m.wave = {diagnostics.wave, diagnostics.wave};
  for (int pass = 0; pass == 0 || (pass < kWavePasses && diagnostics.rigid.moved); ++pass) {
    find_motion(phase, m, diagnostics);
    take_off_harmonics(m.raw, m.wraps, code_, m.motion, m.wave, phase);
    m.wave = refit_wave({phase, m.wraps, code_, 0, diagnostics.noise}, m.motion, config_.refit.max_residual, m.wave);
  }
  take_off_harmonics(m.raw, m.wraps, code_, m.motion, m.wave, phase);
  diagnostics.wave = m.wave.fringe;
  diagnostics.wave_shown = m.wave.fringe;
}

void MicroMode::undo_light(Memory& m, DecodeDiagnostics& diagnostics, PhaseMaps& phase) const {
  const auto find = [&](LampLight of) {
    const MicroBurst burst{phase, m.wraps, code_, diagnostics.third_rad, diagnostics.noise};
    return find_micro_light(burst, m.motion, config_.refit.max_residual, common_.light_change, of, m.light);
  };
  const auto take_off = [&] {
    take_off_light(m.light, diagnostics.noise.black_dn, phase);
    find_motion(phase, m, diagnostics);
  };
  undo_lamp(m.light, find, take_off, diagnostics);
}

RefinedPhase MicroMode::refine(const FringeOrders& orders, const RelativeSurface& relative, Work& work,
                               const StepHook& hook, DecodeDiagnostics& diagnostics, PhaseMaps& phase) const {
  Memory& m = memory_of(work);
  cells_of(relative, m.relative_cells);
  place_spans(orders.spans, m.relative_cells, phase.phase_rad.width(), phase.phase_rad.height(), m.wraps);
  const bool linear = diagnostics.wave.is_cosine();
  if (common_.correct_ripple && linear) {
    diagnostics.third_rad = estimate_third_harmonic(orders.spans, phase).a1_rad;
    correct_third_harmonic(m.wraps, diagnostics.third_rad, phase);
  }
  if (common_.correct_ripple && !linear) undo_wave(m, diagnostics, phase);
  tell(hook, "harmonic");
  if (!common_.correct_closure) return {phase, m.wraps, {}};
  find_motion(phase, m, diagnostics);
  tell(hook, "motion");
  if (linear) undo_light(m, diagnostics, phase);
  tell(hook, "light");
  undo_motion_and_join({orders.spans, m.wraps, code_, m.motion, diagnostics.third_rad, diagnostics.noise},
                       config_.refit, phase, {m.strips, diagnostics.rigid.moved ? &m.misfit : nullptr}, m.join_scratch);
  m.filled.clear();
  if (linear)
    solve_micro_saturated(
        {orders.spans, code_, m.motion, diagnostics.third_rad, diagnostics.noise, geometry_.rays->phase_mid_rad.data()},
        common_.phase, phase, m.wraps, m.filled);
  tell(hook, "refit");
  return {phase, m.wraps, m.filled};
}

}  // namespace enamel::pipeline
