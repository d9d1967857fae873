// Finds a patch again among the keyframes. From any side by surface features, each of which is a whole motion; from the
// same side also by pictures, where a surface too smooth for those has texture. Then ICP, then doubt.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pipeline/register/feature/rigid_ransac.hpp"
#include "pipeline/register/feature/surface_votes.hpp"
#include "pipeline/register/track/acceptance.hpp"
#include "pipeline/register/track/keyframes.hpp"
#include "pipeline/register/track/place_evidence.hpp"

namespace enamel::pipeline {

struct RelocaliseConfig {
  FeatureConfig features;
  RansacConfig ransac;
  VoteConfig votes;
  EvidenceConfig evidence;
  AcceptConfig accept;
  AcceptConfig accept_turned;  ///< overlap and consistency are those of all keyframes near
  int max_verified = 4;        ///< hypotheses that are carried to ICP, most inliers first
  double rival_ratio = 0.7;    ///< another place with this share of the winner's inliers: teeth repeat, refuse both
  double rival_mm = 1.0;       ///< another place: farther than this at the working distance …
  double rival_deg = 4;        ///< … or turned by more than this
  double work_distance_mm = 48;
};

struct Relocalised {
  IcpResult icp;
  std::size_t keyframe = 0;
  int inliers = 0;
};

/// The patch whose place is not known. Refers to its parts.
struct LostPatch {
  const SurfacePatch& patch;
  const PatchPyramid& pyramid;
  std::uint64_t seed;  ///< makes the draws of one burst its own
};

/// Where it may be. Refers to its parts.
struct KnownPlaces {
  KeyframeStore& keyframes;  ///< their features are extracted when they are needed: a few a search
  const Pose& T_model_cam;   ///< last known
  std::uint64_t turn;        ///< counts the searches: what is not tried in one is tried in the next
};

/// Deterministic. lens: of the camera that took the patch and the keyframes. nullopt: not found, or not without doubt.
[[nodiscard]] std::optional<Relocalised> relocalise(const LostPatch& lost, const KnownPlaces& places,
                                                    const calib::LensValues& lens, const IcpConfig& icp,
                                                    const RelocaliseConfig& config);

}  // namespace enamel::pipeline
