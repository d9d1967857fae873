// What a pattern mode adds to the steps of a burst. The decoder makes one strategy when it is made, by the rig's
// pattern set, and asks no more which mode it is.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "pipeline/decode/phase/burst_view.hpp"
#include "pipeline/decode/phase/noise_model.hpp"
#include "pipeline/decode/phase/phase.hpp"
#include "pipeline/decode/phase/waveform_fit.hpp"
#include "pipeline/decode/steps/decoded_burst.hpp"
#include "pipeline/decode/steps/fringe_orders.hpp"
#include "pipeline/decode/steps/refined_phase.hpp"
#include "pipeline/decode/steps/regions.hpp"
#include "pipeline/decode/steps/step_hook.hpp"
#include "pipeline/decode/triangulate/ray_depth.hpp"
#include "pipeline/types/relative_surface.hpp"

namespace enamel::pipeline {

/// What the rig says of its camera's pixels.
struct BurstGeometry {
  std::shared_ptr<const RayDepth> rays;
  Carrier carrier;

  /// Of the picture's middle row, on a surface that faces the camera at mid-range.
  [[nodiscard]] int fringe_px() const;
};

/// Immutable and thread-safe; each thread brings a Work of its own, made by the same strategy. The calls of one burst
/// come in the order in which they stand here.
class PatternStrategy {
 public:
  PatternStrategy() = default;
  PatternStrategy(const PatternStrategy&) = delete;
  PatternStrategy& operator=(const PatternStrategy&) = delete;
  virtual ~PatternStrategy() = default;

  /// What a strategy remembers between the steps of one burst, and memory that it keeps from burst to burst.
  class Work {
   public:
    Work() = default;
    Work(const Work&) = delete;
    Work& operator=(const Work&) = delete;
    virtual ~Work() = default;
  };
  [[nodiscard]] virtual std::unique_ptr<Work> make_work() const = 0;

  /// Frames to wrapped phase, its noise and the physical mask.
  virtual void solve_phase(const BurstView& view, const NoiseModel& noise, Work& work, PhaseMaps& phase) const = 0;

  /// Takes out what the projector's response did to the phase, and tells it as diagnostics.wave. Of frames that go
  /// together: two that are the same picture would pass for a strange response. expected: as for find_waveform.
  virtual void straighten(std::span<const WavePrior> expected, Work& work, DecodeDiagnostics& diagnostics,
                          PhaseMaps& phase) const = 0;

  /// How well the wrapped phase is that of this mode's frames in their order; into the diagnostics, before links.
  virtual void measure_pattern(const PhaseMaps& phase, DecodeDiagnostics& diagnostics) const = 0;
  /// Pixels that links show to be unsure. Before edges are.
  virtual void reject_unsure(Work&, LinkMaps&, Map<PixelReject>&) const {}
  /// The verdict on what measure_pattern found.
  [[nodiscard]] virtual bool shows_pattern(const DecodeDiagnostics& diagnostics) const = 0;
  /// Of a burst that does not: the motion, rad a frame interval, that explains its frames, if it is too fast to be
  /// undone. Mode M's four values a pixel are explained by some motion whatever they are.
  [[nodiscard]] virtual std::optional<float> fast_motion(const PhaseMaps&) const { return std::nullopt; }

  /// Components and their relative orders, by the links. A flood may leak where a cliff is one fringe high, which a
  /// code mends.
  virtual void unwrap(PhaseMaps& phase, Work& work, Regions& regions) const;

  /// Absolute orders of all segments, by the code.
  virtual void find_orders(const PhaseMaps& phase, const Regions& regions, Work& work, DecodeDiagnostics& diagnostics,
                           FringeOrders& out) const = 0;
  /// Why no segment got one.
  [[nodiscard]] virtual BurstVerdict why_unplaced(const PhaseMaps& phase, const Work& work,
                                                  const DecodeDiagnostics& diagnostics) const = 0;
  /// Whether the code that the orders rest on is the rig's.
  [[nodiscard]] virtual bool trusts_orders(const DecodeDiagnostics& diagnostics) const = 0;
  /// Whether unplaced regions are all that such a burst can tell, and worth telling.
  [[nodiscard]] virtual bool tells_unplaced() const { return false; }

  /// Best phase now that orders are known, in place. relative: the regions without.
  [[nodiscard]] virtual RefinedPhase refine(const FringeOrders& orders, const RelativeSurface& relative, Work& work,
                                            const StepHook& hook, DecodeDiagnostics& diagnostics,
                                            PhaseMaps& phase) const = 0;
  /// What this mode's steps have to say of a burst, beside what is told in every mode.
  [[nodiscard]] virtual std::vector<Figure> figures(const DecodeDiagnostics& diagnostics) const = 0;
  /// Whether the four frames are explained by one surface and its motion.
  [[nodiscard]] virtual bool explains_frames(const DecodeDiagnostics&) const { return true; }
};

}  // namespace enamel::pipeline
