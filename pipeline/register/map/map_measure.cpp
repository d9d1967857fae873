#include "pipeline/register/map/map_measure.hpp"

#include <atomic>
#include <optional>
#include <utility>

#include "pipeline/register/map/edge_memo.hpp"

namespace enamel::pipeline {
namespace {

constexpr std::size_t kParts = 20;  // told one after the other

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

MeasuredEdges measure_edges(const MapInput& input, const std::vector<std::size_t>& keyframes,
                            const std::vector<KeyframePair>& pairs, const NodeOf& node, const BowMeasuring& with,
                            const std::function<void(double)>& progress, const std::stop_token& stop) {
  std::vector<EdgeMemo::Measured> found(2 * pairs.size());
  std::atomic<std::size_t> at_hand{0};
  const auto measure = [&](std::size_t n) {
    if (stop.stop_requested()) return;
    KeyframePair pair = pairs[n / 2];
    if (n % 2 == 1) std::swap(pair.i, pair.j);
    const MapBurst &i = input.bursts[keyframes[pair.i]], &j = input.bursts[keyframes[pair.j]];
    const Pose start = j.T_model_cam.inverse() * i.T_model_cam;
    if (auto known = input.memo != nullptr ? input.memo->find({i.id, j.id}, start) : std::nullopt) {
      found[n] = std::move(*known);
      ++at_hand;
    } else {
      found[n] = measure_pair(*node(pair.i), *node(pair.j), start, with);
      if (input.memo != nullptr) input.memo->keep({i.id, j.id}, start, found[n]);
    }
    if (!found[n].edge) return;
    found[n].edge->i = pair.i;
    found[n].edge->j = pair.j;
    found[n].edge->loop = pair.loop;
  };
  for (std::size_t part = 0; part < kParts; ++part) {
    const std::size_t from = part * found.size() / kParts, to = (part + 1) * found.size() / kParts;
    input.for_each(to - from, [&](std::size_t n) { measure(from + n); });
    if (progress) progress(static_cast<double>(part + 1) / kParts);
  }
  MeasuredEdges out;
  out.at_hand = at_hand;
  for (const EdgeMemo::Measured& one : found) {
    if (!one.edge) continue;
    out.of.push_back(*one.edge);
    out.bows.push_back(one.bow);
  }
  return out;
}

}  // namespace enamel::pipeline
