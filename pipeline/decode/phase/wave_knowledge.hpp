// What is known of the projector's waveform before a burst is decoded: from the spread of projectors, from a
// calibration that measured the response, from the bursts before. The bursts of a scan come from one projector, but
// defocus takes more or less of its harmonics from scene to scene.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "calib/model/rig.hpp"
#include "pipeline/decode/phase/waveform.hpp"
#include "pipeline/decode/phase/waveform_fit.hpp"

namespace enamel::pipeline {

/// So many bursts are learned from; what they tell stands for the rest of the scan.
inline constexpr std::size_t kWavesLearned = 12;  // layout: a second of scanning

/// What the first bursts of a scan have shown, each by itself.
struct WaveKnowledge {
  std::array<Waveform, kWavesLearned> shown{};
  std::size_t bursts = 0;

  /// Nothing is learned any more.
  [[nodiscard]] bool is_complete() const noexcept { return bursts == kWavesLearned; }
  /// Median of each harmonic, which some bursts that show another wave do not move. A cosine before the first burst.
  [[nodiscard]] Waveform median() const;
};

/// With one more burst's. Once complete it stays as it is.
void learn(const Waveform& shown, WaveKnowledge& known);

/// The harmonics of a cosine of `patterns` commanded uncorrected to a projector of this response, before blur.
[[nodiscard]] Waveform uncorrected_wave(const calib::ProjectorResponse& response, const calib::PatternValues& patterns);

/// What to expect of a projector of which nothing is known but, where the rig states it, its response: then either
/// patterns go through its inverse, or they do not.
[[nodiscard]] std::vector<WavePrior> priors_of(const calib::Rig& rig, const WaveFitConfig& config);

/// What to expect of the next burst. `before`: what was to be expected of the first one. Empty where the bursts tell
/// that the wave is a cosine.
[[nodiscard]] std::vector<WavePrior> priors_after(const WaveKnowledge& known, const std::vector<WavePrior>& before,
                                                  const WaveFitConfig& config);

/// Whether further bursts would change nothing: the first of them told enough, or they tell that the wave is a cosine.
[[nodiscard]] bool is_settled(const WaveKnowledge& known, const WaveFitConfig& config);

}  // namespace enamel::pipeline
