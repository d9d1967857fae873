// Tables that undo a projector's waveform (waveform.hpp). Frames of one pixel have as many unknowns as a cosine would
// have, so that what w does to their solution depends on the phase that it shows alone. Private to pipeline/decode.
#pragma once

#include <cstddef>
#include <vector>

#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/decode/phase/waveform.hpp"

namespace enamel::pipeline {

/// Sigma of a phase of which the wave says less than a cosine.
[[nodiscard]] inline float widened(float sigma_rad, float factor, float spread_rad) noexcept {
  const float sigma = sigma_rad * factor;
  return root(sigma * sigma + spread_rad * spread_rad);
}

/// Largest sigma of a place in the fringe over that which the mask takes of a pixel's light. derived: sqrt 3, as along
/// a fringe of mode T's three frames (mode_t/faint.hpp).
inline constexpr float kMostAlongFringe = 1.7320508F;

/// The mask behind a wave: a pixel is judged by its light, as that of a cosine is. The places of a fringe where the
/// wave says little would else be cut out of every surface; they are kept with the sigma that they have. Where it says
/// next to nothing they are left out. by_light_rad: as of a cosine; told_rad: widened.
[[nodiscard]] inline bool is_told(float by_light_rad, float told_rad, float max_sigma_rad) noexcept {
  return by_light_rad < max_sigma_rad && told_rad < kMostAlongFringe * max_sigma_rad;
}

/// True phase by the phase shown. Where a wave far from a cosine shows one phase at several, the middle of them.
/// Immutable.
class PhaseTable {
 public:
  struct Entry {
    float turn_rad = 0;    ///< true phase less the phase shown
    float scale = 1;       ///< B over the modulation shown
    float mean = 0;        ///< A less the mean shown, over the modulation shown
    float slope = 1;       ///< of true phase over the phase shown, kLargestWaveSlope at most
    float spread_rad = 0;  ///< sigma of the true phase where several show alike
  };

  PhaseTable(const Waveform& wave, const FrameScheme& frames);

  /// Of a phase shown in [-pi, pi), linear between 1024 of them.
  [[nodiscard]] Entry at(float shown_rad) const noexcept {
    const float x = (shown_rad + kPiF) * (static_cast<float>(kPhases) / kTwoPiF);
    const std::size_t j = x > 0 ? (x < kPhases - 1 ? static_cast<std::size_t>(x) : kPhases - 1) : 0;
    const float part = x - static_cast<float>(j);
    const Entry &a = entries_[j], &b = entries_[j + 1];
    return {a.turn_rad + part * (b.turn_rad - a.turn_rad), a.scale + part * (b.scale - a.scale),
            a.mean + part * (b.mean - a.mean), a.slope + part * (b.slope - a.slope),
            a.spread_rad + part * (b.spread_rad - a.spread_rad)};
  }

 private:
  static constexpr std::size_t kPhases = 1024;  ///< layout: errors below 1e-4 rad

  std::vector<Entry> entries_;
};

/// How much less than a cosine the wave says of each true phase. Immutable.
class WaveWidening {
 public:
  struct Entry {
    float factor = 1;      ///< of the sigma that frames of a cosine of the same B would have
    float spread_rad = 0;  ///< beside it
  };

  WaveWidening(const Waveform& wave, const FrameScheme& frames);
  /// Of a phase in [-pi, pi).
  [[nodiscard]] Entry at(float phase_rad) const noexcept;

 private:
  std::vector<Entry> entries_;
};

/// The cosine that was meant by the level shown, F's inverse: of one frame by itself, whatever its order or sign.
/// Immutable.
class LevelTable {
 public:
  explicit LevelTable(const Waveform& wave);

  /// level: (I - A)/B. NaN where the response is so flat that the level says little, and far beyond the wave's own.
  [[nodiscard]] float cosine_of(float level) const noexcept;

 private:
  std::vector<float> cosine_;
  float lowest_ = 0, per_level_ = 0;
};

}  // namespace enamel::pipeline
