// Rigid motion from point pairs of which most may be wrong.
// Fischler & Bolles 1981 on triples; Umeyama 1991 for the fit; lengths first (pairs of pairs must keep their distance).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "pipeline/types/geometry.hpp"

namespace enamel::pipeline {

struct PointPair {
  Vec3d from;
  Vec3d to;
};

struct RansacConfig {
  double tolerance_mm = 0.15;  ///< of a pair's distance after the motion, and of lengths between pairs
  int draws = 860;             ///< 99.9 % for a fifth of good pairs: ln(0.001)/ln(1 - 0.2^3)
  int min_inliers = 12;
  double min_side_mm = 0.6;  ///< shorter triangles fix no rotation
  int max_pairs = 256;       ///< most compatible first
};

struct RigidFit {
  Pose T_to_from = Pose::Identity();
  int inliers = 0;
  double rms_mm = 0;  ///< of the inliers
};

/// The motion that brings all pairs together best, from -> to. At least three, not on one line.
[[nodiscard]] Pose best_rigid(const std::vector<PointPair>& pairs);

/// Draws come from a counter (seed, draw number): no state, same answer everywhere. nullopt: fewer than min_inliers
/// agree.
[[nodiscard]] std::optional<RigidFit> fit_rigid(const std::vector<PointPair>& pairs, std::uint64_t seed,
                                                const RansacConfig& config);

}  // namespace enamel::pipeline
