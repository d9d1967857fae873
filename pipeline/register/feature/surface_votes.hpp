// Where a patch may lie, by its surface features: each match of two is a whole rigid motion, and each motion is judged
// by how many other matches it explains. That support, over all pictures taken before at once, is the dissertation's
// overlap index: which of them the patch overlaps, and how surely.
#pragma once

#include <span>
#include <vector>

#include "pipeline/register/feature/surface_features.hpp"
#include "pipeline/types/geometry.hpp"

namespace enamel::pipeline {

struct VoteConfig {
  int places_per_feature = 3;  ///< chosen: of a feature's likes at so many distinct places all are tried: teeth repeat
  double same_place_mm = 1.0;  ///< derived: twice what one key point's place is off by
  double explained_mm = 0.8;   ///< derived: 6 mm of lever times 6 degrees of one frame's error, and 0.3 mm of its place
  double explained_deg = 25;   ///< chosen: between normals that seen and hidden surroundings leave differing
  double refined_mm = 0.4;     ///< derived: the place of a key point, 0.2 mm, on both sides, after a common fit
  int min_support = 4;         ///< derived: three points fix the motion, one must confirm it
  double apart_mm = 1.0;       ///< hypotheses nearer than this at the middle of the patch …
  double apart_deg = 8;        ///< … and turned by less are one
  std::size_t max_hypotheses = 5;  ///< chosen: carried on, most supported first; one costs as much as the voting
  int max_tries = 40;  ///< chosen: matches from which a common motion is sought, those that others agree with first
  double rival_share = 0.5;  ///< chosen: a place with less of the first one's support is no rival of it
};

/// The features of one picture taken before. Refers to its parts.
struct KnownFeatures {
  const std::vector<SurfaceFeature>& features;
  Pose T_model_cam;
};

struct PlaceHypothesis {
  Pose T_model_cam = Pose::Identity();
  int support = 0;  ///< features of the patch that it explains
};

/// Most supported first; all of them distinct. Deterministic.
[[nodiscard]] std::vector<PlaceHypothesis> vote_for_places(const std::vector<SurfaceFeature>& patch,
                                                           std::span<const KnownFeatures> known,
                                                           const VoteConfig& config);

}  // namespace enamel::pipeline
