// Finds a patch again from any side: votes of surface features, alignment to what the keyframes show from there, and
// evidence from all of them together.
#pragma once

#include <optional>
#include <vector>

#include "pipeline/register/track/relocalise.hpp"

namespace enamel::pipeline {

/// One place tried.
struct TriedPlace {
  IcpResult icp;
  PlaceEvidence evidence;
  int support = 0;
  std::size_t keyframe = 0;  ///< the nearest
};

/// All that the votes propose, most supported first, aligned and weighed.
[[nodiscard]] std::vector<TriedPlace> try_places(const LostPatch& lost, const KnownPlaces& places,
                                                 const calib::LensValues& lens, const IcpConfig& icp,
                                                 const RelocaliseConfig& config);

/// What all keyframes near say of one place.
[[nodiscard]] PlaceEvidence weigh_found(const LostPatch& lost, const KnownPlaces& places, const Pose& T_model_cam,
                                        const calib::LensValues& lens, const RelocaliseConfig& config);

[[nodiscard]] bool another_place(const Pose& a, const Pose& b, const RelocaliseConfig& config);

/// The one among them that may be believed. nullopt: none, or more than one.
[[nodiscard]] std::optional<Relocalised> choose_place(const std::vector<TriedPlace>& tried, double median_sigma_mm,
                                                      const RelocaliseConfig& config);

}  // namespace enamel::pipeline
