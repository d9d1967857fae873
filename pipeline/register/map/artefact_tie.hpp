// The poses of a solved map tied to a known artefact: its balls are found in the keyframes, named, and become points of
// the graph with their certified distances.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pipeline/register/map/artefact.hpp"
#include "pipeline/register/map/pose_graph.hpp"
#include "pipeline/register/map/sphere_find.hpp"

namespace enamel::pipeline {

struct ArtefactConfig {
  SphereConfig find;
  std::size_t min_sightings = 3;  ///< of a ball; as JoinVotes: one or two are opinions
  double reach_mm = 0.5;          ///< between sightings of one ball in the model
  double tolerance_mm = 0.15;  ///< between measured and certified distance: no map is off by more, a clip that moved is
  double bias_mm = 1e-3;       ///< of a ball's centre and of a distance, as GraphConfig::bias_mm
  double held_sigmas = 4;      ///< a distance that stays farther off than this is one that the surface contradicts
};

struct ArtefactFacts {
  bool used = false;
  std::string why;                ///< not used
  std::vector<std::size_t> seen;  ///< sightings of each certified sphere
  std::size_t other = 0;          ///< sightings at places that are no sphere of it, or were seen too seldom
  struct Distance {
    KnownArtefact::Distance certified;
    double before_mm = 0, before_sigma_mm = 0;  ///< by the map alone
    double after_mm = 0;
    bool held = true;
  };
  std::vector<Distance> distances;  ///< of spheres seen
  double edge_variance = 1;         ///< that explains how far the map was off before
};

/// Spheres of the artefact in one keyframe's patch. Pure, thread-safe.
[[nodiscard]] std::vector<FoundSphere> find_artefact(const SurfacePatch& patch, const calib::LensValues& lens,
                                                     const KnownArtefact& artefact, const SphereConfig& config);

struct MapTie {
  const KnownArtefact& artefact;
  const ArtefactConfig& config;
  const GraphConfig& graph;
};

/// `solved`: without the artefact; becomes the map with it where `used`. of_node: what find_artefact found in each.
[[nodiscard]] ArtefactFacts tie_to_artefact(const std::vector<std::vector<FoundSphere>>& of_node,
                                            const std::vector<MapEdge>& edges, const MapTie& tie, SolvedGraph& solved);

}  // namespace enamel::pipeline
