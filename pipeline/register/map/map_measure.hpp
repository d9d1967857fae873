// Keyframes ready for edges, and the edges between them.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <stop_token>
#include <vector>

#include "pipeline/register/icp/patch_view.hpp"
#include "pipeline/register/map/bow_edge.hpp"
#include "pipeline/register/map/keyframe_choice.hpp"
#include "pipeline/register/map/refine_map.hpp"

namespace enamel::pipeline {

/// Immutable, thread-safe.
class MapNodeMaker {
 public:
  MapNodeMaker(const calib::Rig& rig, const IcpConfig& icp, const MapConfig& config);
  /// `picture` may be null: MapInput::texture.
  [[nodiscard]] MapNode operator()(const SurfacePatch& patch, const TexturePicture* picture) const;

 private:
  PatchViewer viewer_;
  IcpConfig icp_;
  int sample_stride_px_;
  TextureConfig texture_;
};

using NodeOf = std::function<std::shared_ptr<const MapNode>(std::size_t keyframe)>;

/// Edges and what a bow of the rig makes of each.
struct MeasuredEdges {
  std::vector<MapEdge> of;
  std::vector<EdgeBow> bows;
  std::size_t at_hand = 0;  ///< pairs, either way round, that MapInput::memo knew
};

/// Which bursts stand for the scan, and which of them, by number, are laid on each other.
struct MapPairs {
  std::vector<std::size_t> keyframes;
  std::vector<KeyframePair> pairs;
};

/// Of all pairs, both ways round: what one-sided association leaves of a bias has the other sign in the other.
/// Some are missing once `stop` is requested. progress(share done).
[[nodiscard]] MeasuredEdges measure_edges(const MapInput& input, const MapPairs& of, const NodeOf& node,
                                          const BowMeasuring& with, const std::function<void(double)>& progress = {},
                                          const std::stop_token& stop = {});

}  // namespace enamel::pipeline
