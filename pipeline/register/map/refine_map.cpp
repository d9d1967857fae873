#include "pipeline/register/map/refine_map.hpp"

#include <algorithm>
#include <optional>

#include "pipeline/register/map/keyframe_choice.hpp"
#include "pipeline/register/map/map_measure.hpp"
#include "pipeline/types/viewpoint.hpp"
#include "protocol/base/recent.hpp"

namespace enamel::pipeline {
namespace {

// Of the time that it takes.
constexpr double kNodesShare = 0.15;
constexpr double kEdgesShare = 0.83;

/// The store holds copies of all that it makes nodes of: it outlives the call.
std::shared_ptr<const MapNodes> make_nodes(const MapInput& input, const std::vector<std::size_t>& keyframes,
                                           const calib::Rig& rig, const IcpConfig& icp, const MapConfig& config) {
  const auto make = [load = input.load, texture = input.texture, keyframes, maker = MapNodeMaker(rig, icp, config)](
                        std::size_t k) { return maker(load(keyframes[k]), texture(keyframes[k]).get()); };
  auto nodes = std::make_shared<const MapNodes>(keyframes.size(), config.nodes_kept, make);
  input.for_each(std::min(nodes->size(), nodes->most_kept()), [&](std::size_t k) { (void)nodes->get(k); });
  return nodes;
}

/// What of the known artefact each keyframe shows.
std::vector<std::vector<FoundSphere>> find_in(const MapInput& input, const std::vector<std::size_t>& keyframes,
                                              const calib::Rig& rig, const MapConfig& config, const BowVector& bow) {
  std::vector<std::vector<FoundSphere>> out(keyframes.size());
  input.for_each(keyframes.size(), [&](std::size_t k) {
    SurfacePatch patch = input.load(keyframes[k]);
    if (!bow.isZero(0)) BowField(rig).take_out(bow, patch);
    out[k] = find_artefact(patch, rig.camera, *config.known, config.artefact.find);
  });
  return out;
}

/// Bursts between two keyframes follow both, by how near they are in time.
std::vector<Pose> carry_bursts(const std::vector<MapBurst>& bursts, const std::vector<std::size_t>& keyframes,
                               const std::vector<Pose>& solved, double work_distance_mm) {
  std::vector<Pose> out;
  std::size_t k = 0;
  for (std::size_t n = 0; n < bursts.size(); ++n) {
    while (k + 1 < keyframes.size() && keyframes[k + 1] <= n) ++k;
    const Pose& T = bursts[n].T_model_cam;
    const Vec3d centre = T * Vec3d(0, 0, work_distance_mm);
    const auto correction = [&](std::size_t at) {
      const Pose& before = bursts[keyframes[at]].T_model_cam;
      return motion_between(Pose::Identity(), solved[at] * before.inverse(), centre, 1.0);
    };
    Vector6 x = correction(k);
    if (k + 1 < keyframes.size()) {
      const auto from = bursts[keyframes[k]].t_mid, to = bursts[keyframes[k + 1]].t_mid;
      const double share =
          static_cast<double>((bursts[n].t_mid - from).count()) / static_cast<double>((to - from).count());
      if (share > 0 && share < 1) x = (1 - share) * x + share * correction(k + 1);
    }
    out.push_back(apply_motion(x, centre, 1.0, T));
  }
  return out;
}

}  // namespace

RefinedMap refine_map(const MapInput& input, const calib::Rig& rig, const IcpConfig& icp, const MapConfig& config) {
  const double work_distance_mm = calib::middle_depth_mm(rig);
  RefinedMap out;
  for (const MapBurst& burst : input.bursts) out.poses.push_back(burst.T_model_cam);
  const auto keyframes = choose_keyframes(input.bursts, work_distance_mm, config);
  if (!config.refine || keyframes.size() < 2) return out;
  const MapPairs pairs{keyframes, choose_pairs(input.bursts, keyframes, work_distance_mm, config)};
  const auto nodes = make_nodes(input, keyframes, rig, icp, config);
  input.progress(kNodesShare);
  auto [edges, bows, at_hand] = measure_edges(
      input, pairs, [&](std::size_t k) { return nodes->get(k); }, {rig, icp, config.edge, config.bow.edge},
      [&](double share) { input.progress(kNodesShare + kEdgesShare * share); });
  std::vector<Pose> start;
  start.reserve(keyframes.size());
  for (const std::size_t k : keyframes) start.push_back(input.bursts[k].T_model_cam);
  SolvedGraph solved = solve_graph(start, edges, config.graph);
  out.bow = find_bow(solved, edges, bows, config.graph, config.bow);
  if (out.bow->applied) {
    take_out(out.bow->taken_out, config.graph.rho_mm, edges, bows);
    solved = solve_graph(std::move(start), edges, config.graph);
  }
  if (solved.covariance) {
    const double sigma_mm = out.bow->applied ? config.bow.prior_mm : config.bow.sound_mm;
    solved.covariance = covariance_with_bow(solved, edges, bows, config.graph, sigma_mm);
  }
  if (config.known) {
    const MapTie tie{*config.known, config.artefact, config.graph};
    out.artefact = tie_to_artefact(find_in(input, keyframes, rig, config, out.bow->taken_out), edges, tie, solved);
  }
  out.poses = carry_bursts(input.bursts, keyframes, solved.poses, work_distance_mm);
  out.keyframes = keyframes.size();
  out.edges = edges.size();
  out.at_hand = at_hand;
  out.loops = static_cast<std::size_t>(std::ranges::count_if(edges, &MapEdge::loop));
  out.switched_off = solved.switched_off;
  out.sigma0 = solved.sigma0;
  const Vec3d work(0, 0, work_distance_mm);
  out.stations = find_stations(solved, edges, keyframes, work, config.least_way_mm);
  for (std::size_t n = 0; n < out.poses.size(); ++n) {
    const double moved = (out.poses[n] * work - input.bursts[n].T_model_cam * work).norm();
    out.largest_move_mm = std::max(out.largest_move_mm, moved);
  }
  std::vector<MapBurst> seen_from;
  for (std::size_t k = 0; k < keyframes.size(); ++k)
    seen_from.push_back({input.bursts[keyframes[k]].t_mid, solved.poses[k]});
  out.free_space = std::make_shared<const FreeSpace>(nodes, std::move(seen_from), ViewCamera(rig.camera),
                                                     work_distance_mm, config.free_space);
  input.progress(1);
  return out;
}

}  // namespace enamel::pipeline
