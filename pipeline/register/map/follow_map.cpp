#include "pipeline/register/map/follow_map.hpp"

#include "pipeline/register/map/map_measure.hpp"

namespace enamel::pipeline {

std::optional<std::vector<KeyframeMove>> follow_map(
    const MapInput& input, const std::function<std::shared_ptr<const MapNode>(std::size_t burst)>& node,
    const calib::Rig& rig, const IcpConfig& icp, const MapConfig& config, const std::stop_token& stop) {
  const double work_distance_mm = calib::middle_depth_mm(rig);
  const auto keyframes = choose_keyframes(input.bursts, work_distance_mm, config);
  if (keyframes.size() < 2) return std::nullopt;
  const MapPairs pairs{keyframes, choose_pairs(input.bursts, keyframes, work_distance_mm, config)};
  const auto edges = measure_edges(
      input, pairs, [&](std::size_t k) { return node(keyframes[k]); }, {rig, icp, config.edge, config.bow.edge}, {},
      stop);
  if (stop.stop_requested()) return std::nullopt;
  std::vector<Pose> tracked;
  tracked.reserve(keyframes.size());
  for (const std::size_t n : keyframes) tracked.push_back(input.bursts[n].T_model_cam);
  const SolvedGraph solved = solve_graph(tracked, edges.of, config.graph);
  std::vector<KeyframeMove> out;
  out.reserve(keyframes.size());
  for (std::size_t k = 0; k < keyframes.size(); ++k) out.push_back({tracked[k], solved.poses[k]});
  return out;
}

}  // namespace enamel::pipeline
