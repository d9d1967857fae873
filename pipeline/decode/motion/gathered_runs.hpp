// Some pixels of an image row brought together, so that loops over them run side by side. Private to pipeline/decode.
#pragma once

#include <cstddef>

#include "pipeline/decode/phase/pixel_reject.hpp"

namespace enamel::pipeline {

inline constexpr std::size_t kSparseStep = 2;  ///< layout: where not every pixel of a row is asked, every second one is
inline constexpr std::size_t kGatheredRun = 4;  ///< layout: pixels of a run

/// Some pixels of a row: `count` runs of kGatheredRun pixels, each kSparseStep columns from the one before; the first
/// run begins at column `first`, the others each `pitch` columns from the one before. Column 7 of a run exists.
struct GatheredRuns {
  std::size_t first = 0, pitch = 1, count = 0;

  [[nodiscard]] std::size_t pixels() const noexcept { return kGatheredRun * count; }
};

/// Values of a row's pixels brought together, in their order.
void gather_row(const float* row, const GatheredRuns& runs, float* out);

/// 1 where a pixel is not rejected, else 0; reject: of column 0.
void gather_open(const PixelReject* reject, const GatheredRuns& runs, float* out);

}  // namespace enamel::pipeline
