#include "pipeline/register/map/map_measure.hpp"

#include <optional>
#include <utility>

#include "pipeline/register/map/edge_memo.hpp"

namespace enamel::pipeline {
namespace {

constexpr std::size_t kParts = 20;  // told one after the other

/// A pair one way round, and what it was found to be; nothing where the work was stopped.
struct PairEdge {
  KeyframePair pair;
  Pose start = Pose::Identity();
  std::optional<EdgeMemo::Measured> found;
  bool at_hand = false;
};

EdgeMemo::Measured measure_pair(const MapNode& i, const MapNode& j, const Pose& start, const BowMeasuring& with) {
  EdgeMemo::Measured out{measure_edge(i, j, with.rig.camera, start, with.icp, with.edge), {}};
  if (out.edge) out.bow = measure_edge_bow(i, j, *out.edge, with);
  return out;
}

}  // namespace

MapNodeMaker::MapNodeMaker(const calib::Rig& rig, const IcpConfig& icp, const MapConfig& config)
    : viewer_(rig.camera, rig.camera.width, rig.camera.height, config.view_stride_px),
      icp_(icp),
      sample_stride_px_(config.sample_stride_px),
      texture_(config.edge.texture) {}

MapNode MapNodeMaker::operator()(const SurfacePatch& patch, const TexturePicture* picture) const {
  MapNode node;
  node.samples = sample_patch(patch, sample_stride_px_, icp_.samples);
  node.reference = Reference(viewer_(patch, Pose::Identity()), icp_.reference);
  if (picture != nullptr) {
    node.texture = texture_reference(*picture, Pose::Identity());
    node.texture_points = texture_points(patch, *node.texture, texture_);
  }
  return node;
}

MeasuredEdges measure_edges(const MapInput& input, const MapPairs& of, const NodeOf& node, const BowMeasuring& with,
                            const std::function<void(double)>& progress, const std::stop_token& stop) {
  std::vector<PairEdge> edges(2 * of.pairs.size());
  const auto measure = [&](std::size_t n) {
    if (stop.stop_requested()) return;
    PairEdge& edge = edges[n];
    edge.pair = of.pairs[n / 2];
    if (n % 2 == 1) std::swap(edge.pair.i, edge.pair.j);
    const MapBurst& i = input.bursts[of.keyframes[edge.pair.i]];
    const MapBurst& j = input.bursts[of.keyframes[edge.pair.j]];
    edge.start = j.T_model_cam.inverse() * i.T_model_cam;
    if (input.memo != nullptr) edge.found = input.memo->find({i.id, j.id}, edge.start);
    edge.at_hand = edge.found.has_value();
    if (!edge.at_hand) edge.found = measure_pair(*node(edge.pair.i), *node(edge.pair.j), edge.start, with);
  };
  for (std::size_t part = 0; part < kParts; ++part) {
    const std::size_t from = part * edges.size() / kParts, to = (part + 1) * edges.size() / kParts;
    input.for_each(to - from, [&](std::size_t n) { measure(from + n); });
    if (progress) progress(static_cast<double>(part + 1) / kParts);
  }
  MeasuredEdges out;
  for (const PairEdge& edge : edges) {
    if (!edge.found) continue;
    out.at_hand += edge.at_hand ? 1U : 0U;
    const BurstId i = input.bursts[of.keyframes[edge.pair.i]].id, j = input.bursts[of.keyframes[edge.pair.j]].id;
    if (input.memo != nullptr && !edge.at_hand) input.memo->keep({i, j}, edge.start, *edge.found);
    if (!edge.found->edge) continue;
    out.of.push_back(*edge.found->edge);
    out.of.back().i = edge.pair.i;
    out.of.back().j = edge.pair.j;
    out.of.back().loop = edge.pair.loop;
    out.bows.push_back(edge.found->bow);
  }
  return out;
}

}  // namespace enamel::pipeline
