// The loops of flood over one row. Private to pipeline/decode.
#pragma once

#include <cstddef>
#include <cstdint>

namespace enamel::pipeline {

/// What a pixel is to the run of its row.
enum RunMark : std::uint8_t {
  kSameRun,  ///< goes on, on the same wrap count
  kNoPixel,  ///< invalid
  kRunEvent  ///< begins a run, or goes on on another wrap count
};

/// Turns that a phase gains over its neighbour's where it wraps between them: 1, 0, -1.
[[nodiscard]] constexpr int wraps_between(float from, float to) noexcept {
  constexpr float kHalfTurn_rad = 3.14159265358979F;  // layout: pi
  const float d = to - from;
  return static_cast<int>(d < -kHalfTurn_rad) - static_cast<int>(d > kHalfTurn_rad);
}

/// east, quality: of LinkMaps.
void mark_runs(const float* phase, const std::uint8_t* east, const std::uint8_t* quality, std::size_t width,
               std::uint8_t* marks);

/// One of two neighbouring rows.
struct RunRow {
  const float* phase;
  const std::uint8_t* quality;
  const std::int16_t* wraps;  ///< of the phase over its run's first pixel
  const std::int32_t* run;    ///< -1: none
};

/// Columns of the border between two rows.
struct RunBorder {
  std::int16_t* wrap_counts;  ///< of the lower run's zero over the upper run's
  std::uint8_t* weights;      ///< lesser quality of the two pixels, 0 where they are not linked
  std::uint8_t* changes;  ///< 1 where wrap counts or one of the runs are not those of the column before; 0 at the first
};
void compare_runs(const RunRow& upper, const RunRow& lower, const std::uint8_t* south, std::size_t width,
                  const RunBorder& out);

}  // namespace enamel::pipeline
