#include "pipeline/decode/mode_m/micro_mode.hpp"

#include <cmath>
#include <utility>

#include "pipeline/decode/mode_m/chosen.hpp"
#include "pipeline/decode/mode_m/micro_gates.hpp"
#include "pipeline/decode/mode_m/micro_memory.hpp"
#include "pipeline/decode/mode_m/micro_phase.hpp"
#include "pipeline/decode/mode_m/micro_view.hpp"

namespace enamel::pipeline {
namespace {

/// The motion that turns the code by an angle against the three phase frames, which were taken 2/3 of an interval
/// later.
float motion_of_turn(float turn_rad, const MicroCode& code) {
  return -turn_rad / ((1 + code.inverse_ratio) * (2.0F / 3));
}

}  // namespace

MicroMode::MicroMode(MicroCode code, BurstGeometry geometry, const CommonConfig& common, const MicroConfig& config)
    : code_(std::move(code)), geometry_(std::move(geometry)), common_(common), config_(config) {}

std::unique_ptr<PatternStrategy::Work> MicroMode::make_work() const { return std::make_unique<Memory>(); }

MicroMode::Memory& MicroMode::memory_of(Work& work) { return static_cast<Memory&>(work); }

void MicroMode::solve_phase(const BurstView& view, const NoiseModel& noise, Work&, PhaseMaps& phase) const {
  compute_micro_phase(view, noise, common_.phase, phase);
}

void MicroMode::straighten(std::span<const WavePrior> expected, Work& work, DecodeDiagnostics& diagnostics,
                           PhaseMaps& phase) const {
  const FoundWave found = find_waveform(phase, micro_three_step(), geometry_.fringe_px(), common_.wave, expected);
  diagnostics.wave = found.wave, diagnostics.wave_shown = found.shown;
  if (diagnostics.wave.is_cosine()) return;
  memory_of(work).raw.keep(phase);
  linearise_micro(diagnostics.wave, common_.phase, phase);
}

void MicroMode::measure_pattern(const PhaseMaps& phase, DecodeDiagnostics& diagnostics) const {
  diagnostics.direction_share = direction_share(phase, geometry_.carrier);
}

bool MicroMode::shows_pattern(const DecodeDiagnostics& diagnostics) const {
  return diagnostics.direction_share >= config_.direction.min_share;
}

bool MicroMode::unclear(const FringeOrders& orders) const {
  return orders.orders.agreeing_px < config_.motion.clear_agreement * orders.judged_px();
}

/// Returns the mean angle of the code against the orders found.
float MicroMode::label(const PhaseMaps& phase, const Regions& regions, const NoiseModel& noise, Memory& m,
                       FringeOrders& out) const {
  const RayDepth& rays = *geometry_.rays;
  const auto& segments = out.segments.segments;
  find_code_steps(phase, noise, code_, regions.flood, common_.order.unseen_jump_cost, m.steps);
  find_segments(phase, regions.links, regions.flood, {rays.phase_near_rad.data(), rays.phase_far_rad.data()},
                m.steps.cut, out.segments);
  m.evidence.measure(phase, noise, segments, code_, common_.order.outlier_cost);
  pipeline::find_orders(segments, regions.flood.components, m.evidence, common_.order, out.orders);
  const float turn = m.evidence.settle(segments, out.orders);
  judge_orders(segments, m.evidence, out.orders);
  return turn;
}

/// The motion of a surface whose orders are not sure everywhere, from the shape that is likely.
void MicroMode::find_likely_motion(const PhaseMaps& phase, const Regions& regions, Memory& m,
                                   const FringeOrders& orders) const {
  const RayDepth& rays = *geometry_.rays;
  find_likely_wraps(orders.segments.segments, orders.orders.segments, regions.flood.components, phase.phase_rad.width(),
                    phase.phase_rad.height(), m.likely);
  MicroView view(
      {m.wraps, m.likely.wraps, kBeyondRange, code_, 0, phase, rays, m.motion, common_.rigid.max_residual, false});
  if (fit_rigid_motion(view, {phase, m.likely.wraps, rays}, common_.rigid, m.rigid, m.field).moved)
    m.motion.surface = surface_motion(m.field);
}

/// Motion ripples the phase and turns the code, so that segments of one surface seem to differ, and light that changes
/// as the surface passes by is taken for code. The orders found in spite of it show the motion; without it they are
/// found again. The phase stays as it was measured.
void MicroMode::label_without_motion(const PhaseMaps& phase, const Regions& regions, const NoiseModel& noise, Memory& m,
                                     FringeOrders& out) const {
  find_spans(out);
  place_spans(out.spans, {}, phase.phase_rad.width(), phase.phase_rad.height(), m.wraps);
  MicroRefitConfig coarse = config_.refit;
  coarse.row_step *= 2;  // half the rows tell what turns the code by degrees; the phase has a fit of its own
  fit_micro_motion({phase, m.wraps, code_, 0, noise}, coarse, m.motion);
  if (unclear(out) && common_.rigid.passes > 0) find_likely_motion(phase, regions, m, out);
  move_to_code_frame(m.motion, phase, m.at_code);
  label(m.at_code, regions, noise, m, out);
}

void MicroMode::find_orders(const PhaseMaps& phase, const Regions& regions, Work& work, DecodeDiagnostics& diagnostics,
                            FringeOrders& out) const {
  Memory& m = memory_of(work);
  const NoiseModel& noise = diagnostics.noise;
  diagnostics.code_turn_rad = label(phase, regions, noise, m, out);
  const bool moved = std::abs(motion_of_turn(diagnostics.code_turn_rad, code_)) > config_.motion.harmless_motion_rad;
  if (!common_.correct_closure || !(moved || unclear(out))) return;
  label_without_motion(phase, regions, noise, m, out);
  // More orders show the motion better, which once more brings more of them.
  if (unclear(out)) label_without_motion(phase, regions, noise, m, out);
}

BurstVerdict MicroMode::why_unplaced(const PhaseMaps&, const Work&, const DecodeDiagnostics& diagnostics) const {
  const bool mixed = diagnostics.repeated_share > config_.direction.max_unplaced_repeated ||
                     diagnostics.direction_share < config_.direction.min_unplaced_share;
  return mixed ? BurstVerdict::kPatternMismatch : BurstVerdict::kNoCode;
}

bool MicroMode::trusts_orders(const DecodeDiagnostics& diagnostics) const {
  return follows_code(diagnostics, common_.code);
}

std::vector<Figure> MicroMode::figures(const DecodeDiagnostics& d) const {
  const auto of = [](float value) { return std::vector{static_cast<double>(value)}; };
  return {{"direction_share", 5, {d.direction_share}},
          {"code_turn_rad", 6, of(d.code_turn_rad)},
          {"exposure_step", 5, of(d.exposure_step)},
          {"third_rad", 6, of(d.third_rad)}};
}

bool MicroMode::explains_frames(const DecodeDiagnostics& diagnostics) const {
  return !common_.correct_closure || diagnostics.closure_share >= config_.explained.min_share;
}

}  // namespace enamel::pipeline
