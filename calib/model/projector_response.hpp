// What a projector emits of what it is commanded, and which command emits what is wanted.
#pragma once

#include <vector>

namespace enamel::calib {

struct ProjectorResponse {
  std::vector<int> level;        ///< rising, within 0…255; three at least
  std::vector<double> emission;  ///< relative, rising from 0 at the first level to 1 at the last
  double residual = 0;           ///< largest distance from a straight line, share of full scale
};

/// Whether levels and emissions are as stated above, but for the residual: only then is there an inverse.
[[nodiscard]] bool is_rising(const ProjectorResponse& response) noexcept;

/// The level that emits what a linear projector would of `wanted`, straight lines between the measured ones. Levels
/// outside of those stay as they are. Needs is_rising().
[[nodiscard]] double level_for(const ProjectorResponse& response, double wanted) noexcept;

}  // namespace enamel::calib
