// Which balls of a known artefact the balls seen in a scan are. Private to register/map.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/register/map/artefact.hpp"
#include "pipeline/register/map/sphere_find.hpp"

namespace enamel::pipeline {

struct Sighting {
  std::size_t keyframe = 0;
  FoundSphere sphere;
};

/// Sightings of what lies at one place of the model.
struct BallCluster {
  Vec3d centre = Vec3d::Zero();  ///< model frame, mean
  double radius_mm = 0;
  std::vector<Sighting> seen;
};

/// By place in the model: sightings within `reach_mm` of a cluster's mean belong to it. Ordered by first keyframe.
[[nodiscard]] std::vector<BallCluster> cluster_balls(const std::vector<std::vector<FoundSphere>>& of_keyframe,
                                                     const std::vector<Pose>& T_model_cam, double reach_mm);

struct BallMatch {
  std::vector<std::size_t> sphere;  ///< of each cluster; empty when not told
  std::string why;                  ///< not told; with what can be done about it
};

/// The one way to name the clusters for which every certified distance agrees within `tolerance_mm`. Ways that tie the
/// same clusters by the same distances are one. All clusters or none: what lies where no ball can be was moved.
[[nodiscard]] BallMatch match_balls(const std::vector<BallCluster>& clusters, const KnownArtefact& artefact,
                                    double tolerance_mm);

}  // namespace enamel::pipeline
