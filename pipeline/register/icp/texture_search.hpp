// Where else along the weak directions the greys may agree: a hand that starts or stops is not where prediction has it.
// Private to register/icp.
#pragma once

#include <vector>

#include "pipeline/register/icp/texture_sums.hpp"

namespace enamel::pipeline {

/// Motions about the centre, along `weak`, from which a fit is worth a try, the most promising first.
[[nodiscard]] std::vector<Vector6> texture_candidates(const Sliding& sliding, const Pose& T_model_cam,
                                                      const TextureConfig& config);

}  // namespace enamel::pipeline
