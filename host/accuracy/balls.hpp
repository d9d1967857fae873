// Balls of an artefact in a scanned surface: found by votes of the normals, fitted by least squares with radius free.
// mm. Pure, thread-safe.
#pragma once

#include <cstddef>
#include <vector>

#include "pipeline/types/mesh.hpp"

namespace enamel::host {

struct BallConfig {
  double vote_mm = 0.25;     ///< votes for one centre lie within
  double gate_mm = 0.1;      ///< surface so near to a ball is the ball's, if its normal points away from the centre …
  double normal_deg = 25;    ///< … to within: what it stands on, and the fillet between, are not
  double trim_sigmas = 3;    ///< of the robust deviation: points farther off do not draw the fit
  double min_share = 0.1;    ///< of the whole ball that has to be seen: less does not determine a diameter
  double diameter_mm = 0.1;  ///< a ball's differs by less from the one looked for
  double form_mm = 0.1;      ///< range of 95 %; what is less round is no ball
  std::size_t most_votes = 100'000;
  int rounds = 20;
};

struct FittedBall {
  Vec3d centre = Vec3d::Zero();
  double diameter_mm = 0;  ///< that fits best
  double form_mm = 0;      ///< range of 95 % of the radial deviations, of all points of the ball, trimmed or not
  double rms_mm = 0;       ///< of those that the fit took
  double share = 0;        ///< of the whole ball's surface that was seen
  std::size_t points = 0;
};

/// Balls of about that diameter, most surface first, no two in one place.
[[nodiscard]] std::vector<FittedBall> find_balls(const Mesh& mesh, double diameter_mm, const BallConfig& config = {});

}  // namespace enamel::host
