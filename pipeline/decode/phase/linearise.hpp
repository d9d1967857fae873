// Phase maps as a projector with a linear response would have made them. The three phase frames have three unknowns,
// so that what w does to their solution depends on the phase that it shows alone: a table. The code frame is undone by
// F, pixel by pixel, whatever its order or sign: its wave is F of the cosine that was meant (waveform.hpp).
#pragma once

#include <vector>

#include "pipeline/decode/phase/phase.hpp"
#include "pipeline/decode/phase/waveform_fit.hpp"

namespace enamel::pipeline {

/// Made once per waveform. Immutable.
class Lineariser {
 public:
  /// `usable` is false for waves so far from a cosine that two phases look alike.
  Lineariser(const Waveform& wave, const ThreeStep& frames);

  [[nodiscard]] bool usable() const noexcept { return usable_; }

  /// Rewrites all maps but the saturated, dark and clipped pixels' values; kNoisy is decided anew. code_dn becomes NaN
  /// where the response is so flat that the code frame says little.
  void apply(const PhaseConfig& config, PhaseMaps& maps) const;

 private:
  struct Entry {
    float turn_rad = 0;  ///< true phase less the phase shown
    float scale = 1;     ///< B over the modulation shown
    float mean = 0;      ///< A less the mean shown, over the modulation shown
    float slope = 1;     ///< of true phase over the phase shown
  };
  [[nodiscard]] Entry entry(float phase_rad) const noexcept;
  [[nodiscard]] float cosine_of(float level) const noexcept;
  void tabulate_phase(const Waveform& wave, const ThreeStep& frames);
  void tabulate_level(const Waveform& wave);

  bool usable_ = true;
  std::vector<Entry> by_phase_;
  std::vector<float> by_level_;  ///< cosine; NaN where the response is flat
  float lowest_ = 0, per_level_ = 0;
};

/// Finds the waveform of a burst and takes it out of its maps; no harmonics where the burst shows none, or none that
/// can be undone. fringe_px: of the camera, at mid-range.
[[nodiscard]] Waveform linearise(const ThreeStep& frames, int fringe_px, const WaveFitConfig& fit,
                                 const PhaseConfig& config, PhaseMaps& maps);

}  // namespace enamel::pipeline
