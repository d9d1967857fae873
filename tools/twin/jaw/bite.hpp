// Both jaws of a patient, biting on each other as two plaster models in an articulator.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "tools/twin/jaw/jaw.hpp"

namespace enamel::twin {

/// Bite coordinates, mm: z out of the lower arch in the middle of what is meshed of it (towards the cheek, or the
/// lips), x along the lower jaw's z, the origin on the lower arch half-way between the gum margins.
struct Bite {
  TriSurface mesh;  ///< both, bite coordinates
  Eigen::Isometry3d T_bite_lower = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_bite_upper = Eigen::Isometry3d::Identity();
};

/// The jaw that a bite shows of the patient: the whole arch's teeth, meshed where `config` says. The upper's x points
/// to the patient's left, thus its arc runs the other way.
[[nodiscard]] JawConfig jaw_in_bite(JawConfig config, JawSide side);

/// `config`: from_mm and to_mm of the lower arch; side, both_sides and palate count for nothing. The upper is shifted
/// over the lower and let down to where its teeth meet, to some tenths; nothing turns it, so they meet in few places.
[[nodiscard]] Bite make_bite(const JawConfig& config, std::uint64_t seed);

}  // namespace enamel::twin
