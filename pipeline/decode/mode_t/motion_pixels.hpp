// What mode T's burst shows at the pixels that its motion is judged by, brought together once: each pass over the
// motion asks for it, and in the maps each of these pixels lies in a cache line of its own. Private to pipeline/decode.
#pragma once

#include <cstddef>
#include <vector>

#include "pipeline/decode/mode_t/closure_rows.hpp"

namespace enamel::pipeline {

struct MotionSamples;

/// Sampled pixels of one image row, in their order.
struct SampledRow {
  std::size_t count = 0;
  GatheredRuns runs;                                          ///< where they lie
  const float *cosine, *sine, *code, *mean, *phase, *weight;  ///< of PhaseMaps and PolarityMaps
  const float *modulation, *open;                             ///< B; 1 where not rejected, else 0
};

class SampledPixels {
 public:
  /// samples: placed (place_samples).
  void take(const PhaseMaps& maps, const PolarityMaps& polarity, const MotionSamples& samples);
  /// Those of image row v, an even one.
  [[nodiscard]] SampledRow row(int v) const;

 private:
  std::vector<GatheredRuns> runs_;  ///< of every second row
  std::vector<std::size_t> begin_;  ///< of their pixels
  StaggeredVector<float> cosine_, sine_, code_, mean_, phase_, weight_, modulation_, open_;
};

}  // namespace enamel::pipeline
