// Mode M: three phase frames 120 degrees apart and a code frame of a fringe slightly finer, whose beat tells the order.
#pragma once

#include "pipeline/decode/mode_m/micro_code.hpp"
#include "pipeline/decode/mode_m/micro_refit.hpp"
#include "pipeline/decode/steps/common_config.hpp"
#include "pipeline/decode/steps/pattern_strategy.hpp"

namespace enamel::pipeline {

/// Whether the phase runs as the carrier does, before any order is known.
struct DirectionGate {
  /// chosen: on drawn bursts: in order they have 0.78 and more, permuted ones 0.74 at most where they would be
  /// accepted, but for those that WaveGate tells.
  double min_share = 0.75;             ///< of direction_share
  double min_unplaced_share = 0.8;     ///< with less and no order found, the frames are to blame, not the code, ...
  double max_unplaced_repeated = 0.6;  ///< ... as they are with more of two frames alike
};

/// Whether the orders have to be asked again without the motion, which turns the code.
struct MotionOfCodeGate {
  /// chosen: by judgement; asking again was judged on three quadrants of the twin (docs/notes/decode-attempts.md,
  /// motion).
  float harmless_motion_rad = 0.05F;  ///< with more a frame interval
  double clear_agreement = 0.97;      ///< with less; then without the light that passed by as well
};

/// Whether the code frame is what the other three predict under one motion.
struct ExplainedGate {
  double min_share = 0.65;  ///< of placed pixels. chosen: by judgement
};

struct MicroConfig {
  MicroRefitConfig refit;
  DirectionGate direction;
  MotionOfCodeGate motion;
  ExplainedGate explained;
};

class MicroMode final : public PatternStrategy {
 public:
  MicroMode(MicroCode code, BurstGeometry geometry, const CommonConfig& common, const MicroConfig& config);

  [[nodiscard]] std::unique_ptr<Work> make_work() const override;
  void solve_phase(const BurstView& view, const NoiseModel& noise, Work& work, PhaseMaps& phase) const override;
  void straighten(std::span<const WavePrior> expected, Work& work, DecodeDiagnostics& diagnostics,
                  PhaseMaps& phase) const override;
  void measure_pattern(const PhaseMaps& phase, DecodeDiagnostics& diagnostics) const override;
  [[nodiscard]] bool shows_pattern(const DecodeDiagnostics& diagnostics) const override;
  void find_orders(const PhaseMaps& phase, const Regions& regions, Work& work, DecodeDiagnostics& diagnostics,
                   FringeOrders& out) const override;
  [[nodiscard]] BurstVerdict why_unplaced(const PhaseMaps& phase, const Work& work,
                                          const DecodeDiagnostics& diagnostics) const override;
  [[nodiscard]] bool trusts_orders(const DecodeDiagnostics& diagnostics) const override;
  [[nodiscard]] RefinedPhase refine(const FringeOrders& orders, const RelativeSurface& relative, Work& work,
                                    const StepHook& hook, DecodeDiagnostics& diagnostics,
                                    PhaseMaps& phase) const override;
  [[nodiscard]] std::vector<Figure> figures(const DecodeDiagnostics& diagnostics) const override;
  [[nodiscard]] bool explains_frames(const DecodeDiagnostics& diagnostics) const override;

 private:
  struct Memory;
  [[nodiscard]] static Memory& memory_of(Work& work);
  [[nodiscard]] bool unclear(const FringeOrders& orders) const;
  float label(const PhaseMaps& phase, const Regions& regions, const NoiseModel& noise, Memory& m,
              FringeOrders& out) const;
  void label_without_motion(const PhaseMaps& phase, const Regions& regions, const NoiseModel& noise, Memory& m,
                            FringeOrders& out) const;
  void find_likely_motion(const PhaseMaps& phase, const Regions& regions, Memory& m, const FringeOrders& orders) const;
  void find_motion(const PhaseMaps& phase, Memory& m, DecodeDiagnostics& diagnostics) const;
  void undo_light(Memory& m, DecodeDiagnostics& diagnostics, PhaseMaps& phase) const;
  void undo_wave(Memory& m, DecodeDiagnostics& diagnostics, PhaseMaps& phase) const;

  MicroCode code_;
  BurstGeometry geometry_;
  CommonConfig common_;
  MicroConfig config_;
};

}  // namespace enamel::pipeline
