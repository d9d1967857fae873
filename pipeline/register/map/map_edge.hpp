// The quadratic of one alignment: two keyframes that are known to overlap, laid on each other as exactly as they allow.
#pragma once

#include <cstddef>
#include <optional>

#include "calib/model/rig.hpp"
#include "pipeline/register/icp/icp.hpp"
#include "pipeline/register/icp/texture_term.hpp"
#include "pipeline/register/map/pose_graph.hpp"

namespace enamel::pipeline {

struct EdgeConfig {
  double first_gate_mm = 0.2;  ///< live poses are known to some hundredths …
  double gate_mm = 0.15;       ///< … and after the first round to microns: as the finest level of tracking
  int rounds = 5;
  double max_normal_deg = 30;
  double min_overlap = 0.2;      ///< less common surface is no edge
  double min_consistency = 0.8;  ///< as AcceptConfig: of what falls on the other, the share that agrees
  double max_rms_mm = 0.03;
  int texture_turns = 2;  ///< texture and shape by turns, where shape leaves directions free
  TextureConfig texture;
};

/// One keyframe ready for edges, in its own camera's frame.
struct MapNode {
  SampleSet samples;
  Reference reference;
  TexturePoints texture_points;  ///< both empty where shape determined the burst's motion
  std::optional<TextureReference> texture;
};

/// i against j from `start` = T_j_i. nullopt: too little in common, or it does not fit. Pure.
[[nodiscard]] std::optional<MapEdge> measure_edge(const MapNode& i, const MapNode& j, const calib::LensValues& lens,
                                                  const Pose& start, const IcpConfig& icp, const EdgeConfig& config);

}  // namespace enamel::pipeline
