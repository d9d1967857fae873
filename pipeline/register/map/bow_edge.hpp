// What a bow of the rig does to one alignment: where it lays the two keyframes, and what it leaves between them.
#pragma once

#include "pipeline/register/map/bow_factors.hpp"
#include "pipeline/register/map/map_edge.hpp"

namespace enamel::pipeline {

struct BowEdgeConfig {
  std::size_t every = 8;      ///< chosen: samples left out between two; a pair's bias is larger than their noise
  double expected_mm = 0.02;  ///< as BowConfig::prior_mm
  double bias_mm = 1e-3;      ///< as GraphConfig: what stays between two surfaces however many points they share
};

struct BowMeasuring {
  const calib::Rig& rig;
  const IcpConfig& icp;
  const EdgeConfig& edge;
  const BowEdgeConfig& bow;
};

/// The edge's own nodes. Pure.
[[nodiscard]] EdgeBow measure_edge_bow(const MapNode& i, const MapNode& j, const MapEdge& edge,
                                       const BowMeasuring& with);

}  // namespace enamel::pipeline
