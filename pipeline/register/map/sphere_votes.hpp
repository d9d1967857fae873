// Where the votes for a ball's centre meet. Pure, thread-safe.
#pragma once

#include <vector>

#include "pipeline/types/geometry.hpp"

namespace enamel::pipeline {

struct VotePeak {
  Vec3f at = Vec3f::Zero();
  int votes = 0;  ///< within reach of it
};

/// Peaks of at least min_votes within reach_mm, no two nearer than apart_mm; most votes first.
[[nodiscard]] std::vector<VotePeak> find_peaks(const std::vector<Vec3f>& votes, float reach_mm, float apart_mm,
                                               int min_votes);

}  // namespace enamel::pipeline
