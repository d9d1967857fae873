// Mode T, the dissertation's own burst: four frames a quarter of a period apart, the fourth with a sign in every half
// fringe that marks the absolute phase. Single-marker sets are the same with another code; PlainFourStep has none.
#pragma once

#include "pipeline/decode/mode_t/cell_signs.hpp"
#include "pipeline/decode/mode_t/closure.hpp"
#include "pipeline/decode/mode_t/flip_blur.hpp"
#include "pipeline/decode/mode_t/polarity.hpp"
#include "pipeline/decode/mode_t/torn.hpp"
#include "pipeline/decode/steps/common_config.hpp"
#include "pipeline/decode/steps/pattern_strategy.hpp"
#include "pipeline/decode/unwrap/cut_costs.hpp"

namespace enamel::pipeline {

/// Whether the fourth frame is as the other three predict it, A + S or A - S.
struct ClosureGate {
  /// chosen: by judgement.
  double min_share = 0.65;           ///< of lit pixels
  double min_unplaced_share = 0.85;  ///< with less and no order found, the frames are to blame, not the code
};

/// Whether motion explains frames that do not close at rest.
struct FastMotionGate {
  /// Of pixels that close under a motion. chosen: on rendered bursts, of which moving ones reach 81 % and more,
  /// permuted and left-over frames 68 % at most (docs/notes/decode-attempts.md, frames that do not belong together).
  double min_moving_share = 0.8;
  /// chosen: by judgement. Motion of this at least: with less it is not what spoils a burst.
  double least_motion_rad = 0.15;
};

/// Whether the phase runs as the carrier does, before any order is known. In the dark its direction is unsure, but then
/// links, which allow for noise, hold: frames 1 and 3 in each other's place break both.
struct RunningGate {
  /// chosen: on drawn bursts, of which true ones with less direction have links of 0.999 and more, and those with the
  /// two frames in each other's place at most 0.89 where they would be accepted.
  double min_direction_share = 0.75, sound_linked_share = 0.97;
};

struct FourStepConfig {
  PolarityConfig polarity;
  ClosureConfig closure;
  FlipBlurConfig flips;
  TornConfig torn;
  CutConfig cuts;  ///< of patterns without a code
  ClosureGate closes;
  RunningGate runs;
  FastMotionGate fast;
  /// Of DecodeDiagnostics::odd_blocks. derived: with none, nothing says that the four frames belong together.
  std::size_t min_odd_blocks = 1;
};

class FourStepMode : public PatternStrategy {
 public:
  FourStepMode(CellSigns signs, BurstGeometry geometry, const CommonConfig& common, const FourStepConfig& config);

  [[nodiscard]] std::unique_ptr<Work> make_work() const override;
  void solve_phase(const BurstView& view, const NoiseModel& noise, Work& work, PhaseMaps& phase) const override;
  void straighten(std::span<const WavePrior> expected, Work& work, DecodeDiagnostics& diagnostics,
                  PhaseMaps& phase) const override;
  void measure_pattern(const PhaseMaps& phase, DecodeDiagnostics& diagnostics) const override;
  void reject_unsure(Work& work, LinkMaps& links, Map<PixelReject>& reject) const override;
  [[nodiscard]] bool shows_pattern(const DecodeDiagnostics& diagnostics) const override;
  [[nodiscard]] std::optional<float> fast_motion(const PhaseMaps& phase) const override;
  void find_orders(const PhaseMaps& phase, const Regions& regions, Work& work, DecodeDiagnostics& diagnostics,
                   FringeOrders& out) const override;
  [[nodiscard]] BurstVerdict why_unplaced(const PhaseMaps& phase, const Work& work,
                                          const DecodeDiagnostics& diagnostics) const override;
  [[nodiscard]] bool trusts_orders(const DecodeDiagnostics& diagnostics) const override;
  [[nodiscard]] bool explains_frames(const DecodeDiagnostics& diagnostics) const override;
  [[nodiscard]] RefinedPhase refine(const FringeOrders& orders, const RelativeSurface& relative, Work& work,
                                    const StepHook& hook, DecodeDiagnostics& diagnostics,
                                    PhaseMaps& phase) const override;
  [[nodiscard]] std::vector<Figure> figures(const DecodeDiagnostics& diagnostics) const override;

 protected:
  struct Memory;
  [[nodiscard]] static Memory& memory_of(Work& work);

  CellSigns signs_;
  BurstGeometry geometry_;
  CommonConfig common_;
  FourStepConfig config_;

 private:
  void find_motion(const PhaseMaps& phase, Memory& m, DecodeDiagnostics& diagnostics) const;
  void tell_odd_frame(const PhaseMaps& phase, const Memory& m, DecodeDiagnostics& diagnostics) const;
  void undo_light(const FringeOrders& orders, Memory& m, DecodeDiagnostics& diagnostics, PhaseMaps& phase) const;
  void undo_wave(const FringeOrders& orders, Memory& m, DecodeDiagnostics& diagnostics, PhaseMaps& phase) const;
  void undo_motion(const FringeOrders& orders, Memory& m, DecodeDiagnostics& diagnostics, PhaseMaps& phase) const;
  void undo_ripple(const FringeOrders& orders, Memory& m, DecodeDiagnostics& diagnostics, PhaseMaps& phase) const;
};

/// Four steps without a code: what the depth range leaves one order is placed by it, and of the rest it is told what
/// hangs together.
class PlainFourStep final : public FourStepMode {
 public:
  using FourStepMode::FourStepMode;

  /// Cut where it costs least: nothing else would mend a leak.
  void unwrap(PhaseMaps& phase, Work& work, Regions& regions) const override;
  [[nodiscard]] bool trusts_orders(const DecodeDiagnostics&) const override { return true; }
  [[nodiscard]] bool tells_unplaced() const override { return true; }
};

}  // namespace enamel::pipeline
