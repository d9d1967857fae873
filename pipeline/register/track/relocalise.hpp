// Finds a patch again among the keyframes: features, then RANSAC, then ICP, then doubt.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pipeline/register/feature/rigid_ransac.hpp"
#include "pipeline/register/track/acceptance.hpp"
#include "pipeline/register/track/keyframes.hpp"

namespace enamel::pipeline {

struct RelocaliseConfig {
  RansacConfig ransac;
  AcceptConfig accept;
  int max_verified = 4;      ///< hypotheses that are carried to ICP, most inliers first
  double rival_ratio = 0.7;  ///< another place with this share of the winner's inliers: teeth repeat, refuse both
  double rival_mm = 1.0;     ///< another place: farther than this at the working distance …
  double rival_deg = 4;      ///< … or turned by more than this
  double work_distance_mm = 48;
};

struct Relocalised {
  IcpResult icp;
  std::size_t keyframe = 0;
  int inliers = 0;
};

/// The patch whose place is not known. Refers to its parts.
struct LostPatch {
  const std::vector<Feature>& features;
  const PatchPyramid& pyramid;
  std::uint64_t seed;  ///< makes the draws of one burst its own
};

/// Where it may be. Refers to its parts.
struct KnownPlaces {
  const std::vector<Keyframe>& keyframes;
  const std::vector<std::size_t>& candidates;  ///< indices into keyframes
};

/// Deterministic. `ratio` of the best descriptor distance to the second best, below which a match counts. nullopt: not
/// found, or not without doubt.
[[nodiscard]] std::optional<Relocalised> relocalise(const LostPatch& patch, const KnownPlaces& places,
                                                    const ViewCamera& camera, double ratio, const IcpConfig& icp,
                                                    const RelocaliseConfig& config);

}  // namespace enamel::pipeline
