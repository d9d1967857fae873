// One burst to one surface patch: phase, regions, fringe orders, refined phase, surface.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "calib/model/rig.hpp"
#include "pipeline/decode/decode_config.hpp"
#include "pipeline/decode/phase/burst_view.hpp"
#include "pipeline/decode/phase/wave_knowledge.hpp"
#include "pipeline/decode/steps/decoded_burst.hpp"
#include "pipeline/decode/steps/pattern_strategy.hpp"
#include "pipeline/decode/steps/step_hook.hpp"

namespace enamel::pipeline {

/// Memory that one caller (one thread) reuses from burst to burst.
class DecodeWorkspace {
 public:
  /// For timing by whoever has a clock.
  StepHook on_step;

 private:
  friend class BurstDecoder;
  /// What one step of a burst hands to the next, in their order.
  struct Steps {
    PhaseMaps phase;
    Regions regions;
    FringeOrders orders;
    std::vector<float> scratch;
  };

  Steps steps_;
  std::shared_ptr<const PatternStrategy> strategy_;  ///< whose `work_` this is
  std::unique_ptr<PatternStrategy::Work> work_;
};

/// What is known from the bursts before one.
struct BurstsBefore {
  /// As far as they are known; kBurstsRemembered of them are enough. A frame left over from one of them is told.
  std::span<const BurstView> views;
  WaveKnowledge wave;  ///< of the scan's projector; each accepted burst's diagnostics.wave_shown adds to it
};

/// Immutable: decode() is const and thread-safe, each thread with its own workspace and output.
class BurstDecoder {
 public:
  /// Bakes the rig's per-pixel geometry (about half a second for VGA). Errors: kPatternSet (mode multi, fringes along
  /// v), kPatternAmbiguous (a code that leaves orders of the depth range alike), kRigInvalid (no depth range given
  /// anywhere, or one of absurdly many fringes; geometry that does not determine depth; mode M without `noise`, which
  /// no closure residual can stand in for).
  [[nodiscard]] static Result<BurstDecoder> make(const calib::Rig& rig, const DecodeConfig& config = {});

  /// `out` keeps its memory. On rejection the maps that were reached are filled, the patch is empty (all NaN).
  void decode(const BurstView& view, DecodeWorkspace& workspace, DecodedBurst& out,
              const BurstsBefore& before = {}) const;

  /// The same with fresh memory.
  [[nodiscard]] DecodedBurst decode(const BurstView& view) const;

  /// What the rig's pattern mode has to say of a burst, beside what is told in every mode.
  [[nodiscard]] std::vector<Figure> figures(const DecodeDiagnostics& diagnostics) const {
    return strategy_->figures(diagnostics);
  }
  [[nodiscard]] const RayDepth& rays() const noexcept { return *rays_; }
  [[nodiscard]] std::shared_ptr<const RayDepth> shared_rays() const noexcept { return rays_; }
  [[nodiscard]] const DecodeConfig& config() const noexcept { return config_; }
  /// Modulation over mean light that this burst's fringes have on plaster.
  [[nodiscard]] float opaque_contrast(const DecodeDiagnostics& diagnostics) const noexcept {
    return plaster_contrast(seen_through(diagnostics.wave, optics_));
  }

 private:
  struct Burst;

  BurstDecoder() = default;
  [[nodiscard]] BurstVerdict run(const Burst& burst) const;
  [[nodiscard]] BurstVerdict find_phase(const Burst& burst) const;
  [[nodiscard]] BurstVerdict find_regions(const Burst& burst) const;
  [[nodiscard]] BurstVerdict find_orders(const Burst& burst) const;
  [[nodiscard]] BurstVerdict find_surface(const Burst& burst) const;
  [[nodiscard]] BurstVerdict contradiction(const Burst& burst) const;

  std::shared_ptr<const RayDepth> rays_;
  Carrier carrier_;
  std::shared_ptr<const PatternStrategy> strategy_;
  PatternOptics optics_;
  std::optional<calib::NoiseValues> noise_;
  std::vector<WavePrior> wave_priors_;  ///< of a scan's first burst
  DecodeConfig config_;
};

}  // namespace enamel::pipeline
