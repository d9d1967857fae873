// Pixels of mode T that an edge passed by while the frames of a burst were taken. Frames before and after it show two
// surfaces, and the closure residual stands out of noise by more than motion and light explain; such pixels are left
// out. But where the first three frames, or the last three, continue the surface beside the pixel in phase, light and
// modulation, they saw that surface and are enough (three_frames.hpp). Pixels that were left out as edges before motion
// and orders were known are asked the same, pixel by pixel away from what holds. Nothing of the neighbours goes into
// the phase: they choose the frames.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "pipeline/decode/mode_t/cell_signs.hpp"
#include "pipeline/decode/mode_t/closure_rows.hpp"
#include "pipeline/decode/mode_t/polarity.hpp"
#include "pipeline/decode/mode_t/saturated.hpp"
#include "pipeline/decode/mode_t/three_frames.hpp"
#include "pipeline/decode/phase/cell_span.hpp"
#include "pipeline/decode/phase/misfit.hpp"
#include "pipeline/decode/phase/noise_model.hpp"
#include "pipeline/decode/phase/phase.hpp"

namespace enamel::pipeline {

struct TornConfig {
  float sigmas = kTornSigmas;  ///< of the closure residual
  /// From pixels that hold. derived: at 2 px a frame an edge is 3 px off its place at mid-burst, 3/2 intervals away.
  int reach_px = 3;
  /// A phase may be off the line through the three pixels beside it by. derived: noise alone loses 0.3 % by it.
  float continues_sigmas = 3;
  /// chosen: by judgement. The phase may be off by no more than this, and A differ by this share from the pixel beside
  /// it, B by half as much again.
  float most_turn_rad = 0.3F;
  float same_light = 0.1F;
  /// Joins sigma. derived: same_light/sqrt(2), by which so much of another surface's light turns the phase, rms.
  float mixed_rad = 0.07F;
};

/// One burst's; keeps its memory between bursts. Not thread-safe.
class TornPixels {
 public:
  /// spans: of all decided segments; saturated: solved without a frame, which are not asked; both in row order,
  /// borrowed until the last row was taken. gates: of pixels in general, which those given back have to pass. Size of
  /// the maps.
  void start(std::span<const CellSpan> spans, std::span<const SaturatedPixel> saturated, const TornConfig& config,
             const PhaseConfig& gates, int width, int height);

  /// Every row once, in order, after frame 3 joined; `row` begins at pixel `at` of the maps. closed: of the row; its
  /// `noise` becomes 0 where a pixel is torn, which is rejected (kEdge).
  void take_row(int v, std::size_t at, const PixelRow& row, const ClosedRow& closed, PixelReject* reject);

  /// Gives back what three frames place: phase at mid-burst, wrap count, sigma, A and B of `maps`, no longer rejected.
  void regain(const CellSigns& signs, const NoiseModel& noise, PhaseMaps& maps, Map<std::int16_t>& wraps);

  /// Indices of those pixels.
  [[nodiscard]] const std::vector<std::size_t>& regained() const noexcept { return regained_; }

 private:
  /// A pixel left out: its frames above black as they were taken, and what motion does to them.
  struct Pixel {
    std::size_t index;
    Frames frames;
    PixelChange change;
    float harmonic;
    unsigned asked;  ///< lines that it did not continue, a bit each
  };
  /// What three of its frames make of it.
  struct Way {
    float phase_rad, sigma_rad, mean_dn, modulation_dn, sine;  ///< sine: of the phase
  };
  struct Found {
    std::size_t index;
    Way way;
    float absolute_rad;  ///< Phi
  };
  struct Surface;  ///< what holds so far
  struct Line;     ///< of three of its pixels, on to the pixel asked

  [[nodiscard]] bool was_saturated(std::size_t index);
  void take(std::size_t u, std::size_t index, const PixelRow& row);
  [[nodiscard]] std::optional<Found> find(Pixel& pixel, const Surface& surface) const;
  [[nodiscard]] bool could_be(float mean, const Line& line, const NoiseModel& noise) const;
  [[nodiscard]] float sigmas_off(const Way& way, float off_rad, const Line& line, const NoiseModel& noise) const;
  void put(PhaseMaps& maps, Map<std::int16_t>& wraps);
  [[nodiscard]] static Way way_without(std::size_t missing, const Pixel& pixel, const NoiseModel& noise);

  TornConfig config_;
  float max_sigma_rad_ = 0;
  std::span<const CellSpan> spans_;  ///< those of rows not taken yet
  std::span<const SaturatedPixel> saturated_;
  std::vector<Pixel> pixels_;
  std::vector<Found> found_;
  std::vector<std::size_t> regained_;
  std::vector<std::uint8_t> beside_;  ///< 1: next to a pixel regained in the round before
  int width_ = 0, height_ = 0;
};

}  // namespace enamel::pipeline
