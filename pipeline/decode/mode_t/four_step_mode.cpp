#include "pipeline/decode/mode_t/four_step_mode.hpp"

#include <cmath>
#include <utility>

#include "pipeline/decode/mode_t/closure_gates.hpp"
#include "pipeline/decode/mode_t/faint.hpp"
#include "pipeline/decode/mode_t/fast_motion.hpp"
#include "pipeline/decode/mode_t/four_step_memory.hpp"

namespace enamel::pipeline {

FourStepMode::FourStepMode(CellSigns signs, BurstGeometry geometry, const CommonConfig& common,
                           const FourStepConfig& config)
    : signs_(std::move(signs)), geometry_(std::move(geometry)), common_(common), config_(config) {}

std::unique_ptr<PatternStrategy::Work> FourStepMode::make_work() const { return std::make_unique<Memory>(); }

FourStepMode::Memory& FourStepMode::memory_of(Work& work) { return static_cast<Memory&>(work); }

void FourStepMode::solve_phase(const BurstView& view, const NoiseModel& noise, Work& work, PhaseMaps& phase) const {
  compute_phase(view, noise, common_.phase, phase);
  admit_faint(common_.phase, phase);
  solve_saturated(view, noise, common_.phase, phase, memory_of(work).saturated);
}

void FourStepMode::straighten(std::span<const WavePrior> expected, Work& work, DecodeDiagnostics& diagnostics,
                              PhaseMaps& phase) const {
  Memory& m = memory_of(work);
  const FoundWave found = find_waveform(phase, four_step_three(), geometry_.fringe_px(), common_.wave, expected);
  diagnostics.wave = found.wave, diagnostics.wave_shown = found.shown;
  if (diagnostics.wave.is_cosine()) return;
  // Three frames of another kind would need a table of their own.
  for (const SaturatedPixel& p : m.saturated) phase.reject[p.index] = PixelReject::kSaturated;
  m.saturated.clear();
  m.raw.keep(phase);
  linearise_four_step(diagnostics.wave, common_.phase, phase);
}

void FourStepMode::measure_pattern(const PhaseMaps& phase, DecodeDiagnostics& diagnostics) const {
  diagnostics.closure_share = closure_share(phase, diagnostics.noise);
  diagnostics.direction_share = direction_share(phase, geometry_.carrier);
}

void FourStepMode::reject_unsure(Work& work, LinkMaps& links, Map<PixelReject>& reject) const {
  reject_parted(memory_of(work).saturated, links, reject);
}

bool FourStepMode::shows_pattern(const DecodeDiagnostics& diagnostics) const {
  const bool runs = diagnostics.direction_share >= config_.runs.min_direction_share ||
                    diagnostics.linked_share >= config_.runs.sound_linked_share;
  return runs && diagnostics.closure_share >= config_.closes.min_share;
}

std::optional<float> FourStepMode::fast_motion(const PhaseMaps& phase) const {
  const FastMotion motion = explain_by_motion(phase);
  const bool fast =
      motion.share >= config_.fast.min_moving_share && std::abs(motion.motion_rad) >= config_.fast.least_motion_rad;
  return fast ? std::optional(static_cast<float>(motion.motion_rad)) : std::nullopt;
}

void FourStepMode::find_orders(const PhaseMaps& phase, const Regions& regions, Work& work,
                               DecodeDiagnostics& diagnostics, FringeOrders& out) const {
  static const Map<std::uint8_t> kNoCuts;
  PolarityEvidence& evidence = memory_of(work).evidence;
  const RayDepth& rays = *geometry_.rays;
  find_segments(phase, regions.links, regions.flood, {rays.phase_near_rad.data(), rays.phase_far_rad.data()}, kNoCuts,
                out.segments);
  evidence.measure(phase, diagnostics.noise, out.segments.segments, signs_, common_.order.outlier_cost);
  pipeline::find_orders(out.segments.segments, regions.flood.components, evidence, common_.order, out.orders);
  judge_orders(out.segments.segments, evidence, out.orders);
}

BurstVerdict FourStepMode::why_unplaced(const PhaseMaps& phase, const Work& work,
                                        const DecodeDiagnostics& diagnostics) const {
  const auto& saturated = static_cast<const Memory&>(work).saturated;
  if (saturated.size() > count_of(phase, PixelReject::kRelative) / 2) return BurstVerdict::kSaturated;
  const bool torn = diagnostics.closure_share < config_.closes.min_unplaced_share;
  return torn ? BurstVerdict::kPatternMismatch : BurstVerdict::kNoCode;
}

std::vector<Figure> FourStepMode::figures(const DecodeDiagnostics& d) const {
  const auto of = [](float value) { return std::vector{static_cast<double>(value)}; };
  return {{"closure_share", 5, {d.closure_share}},
          {"odd_shift_rad", 5, of(d.odd_shift_rad)},
          {"unrest", 5, of(d.unrest)},
          {"exposure_step", 5, of(d.exposure_step)},
          {"harmonic", 6, of(d.harmonic)},
          {"ripple_cosine_rad", 6, {d.ripple.cosine.begin(), d.ripple.cosine.end()}, true},
          {"ripple_sine_rad", 6, {d.ripple.sine.begin(), d.ripple.sine.end()}, true},
          {"ripple_by_depth_rad", 6, {d.ripple_by_depth_rad}}};
}

/// One saturated frame leaves three, and any three make a phase: somewhere four must go together.
bool FourStepMode::explains_frames(const DecodeDiagnostics& diagnostics) const {
  return !diagnostics.odd_blocks || *diagnostics.odd_blocks >= config_.min_odd_blocks;
}

bool FourStepMode::trusts_orders(const DecodeDiagnostics& diagnostics) const {
  return follows_code(diagnostics, common_.code);
}

}  // namespace enamel::pipeline
