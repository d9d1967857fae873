// Whether a scan shows a bow of the rig itself, and what to do about it.
#pragma once

#include <memory>
#include <vector>

#include "pipeline/register/map/bow_edge.hpp"
#include "pipeline/register/map/pose_graph.hpp"

namespace enamel::pipeline {

struct BowConfig {
  /// Sigma of each term before the scan: chosen, what a fall, a warm day or a worn mount may leave of a calibration
  /// that was right once. A fresh one is far better and says nothing of that.
  double prior_mm = 0.02;
  /// Sigma of a rig that shows none; derived: half of what a calibration may be bowed by, calib's
  /// JudgementLimits::bow_um.
  double sound_mm = 2.5e-4;
  double sigmas = 3;         ///< beyond as many of its own a bow is believed …
  double determined = 0.25;  ///< … along what the scan knows to this part of the prior's sigma or better
  BowEdgeConfig edge;
};

struct BowFacts {
  BowVector bow = BowVector::Zero();    ///< best estimate, the prior's pull included
  BowVector sigma = BowVector::Zero();  ///< mm
  double rolled_deg = 0;                ///< most of two views of one place about the viewing axis, 0 … 90
  int determined = 0;                   ///< mixtures of the terms that the scan tells, of kBowTerms
  bool applied = false;
  BowVector taken_out = BowVector::Zero();  ///< along what is determined; zero where not applied
};

/// `solved`: the same edges without a bow. `bows`: of each edge. Pure.
[[nodiscard]] BowFacts find_bow(const SolvedGraph& solved, const std::vector<MapEdge>& edges,
                                const std::vector<EdgeBow>& bows, const GraphConfig& graph, const BowConfig& config);

/// What an estimate is worth: `bow` to `taken_out`. Sufficient roll shows in the covariance alone.
[[nodiscard]] BowFacts judge_bow(const BowEstimate& estimate, const BowConfig& config);

/// The edges as they would have been measured without the bow, and what they still say of one.
void take_out(const BowVector& bow, double rho_mm, std::vector<MapEdge>& edges, std::vector<EdgeBow>& bows);

/// Of the poses, with a bow of this sigma among what is not known: it bends a whole arch and leaves no residual.
[[nodiscard]] std::shared_ptr<const GraphCovariance> covariance_with_bow(const SolvedGraph& solved,
                                                                         const std::vector<MapEdge>& edges,
                                                                         const std::vector<EdgeBow>& bows,
                                                                         GraphConfig graph, double sigma_mm);

}  // namespace enamel::pipeline
