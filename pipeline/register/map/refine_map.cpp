#include "pipeline/register/map/refine_map.hpp"

#include <algorithm>
#include <optional>

#include "pipeline/register/icp/patch_view.hpp"
#include "pipeline/register/map/keyframe_choice.hpp"
#include "pipeline/types/viewpoint.hpp"
#include "protocol/base/recent.hpp"

namespace enamel::pipeline {
namespace {

// Of the time that it takes.
constexpr double kNodesShare = 0.15;
constexpr double kEdgesShare = 0.83;
constexpr std::size_t kParts = 20;  // told one after the other

/// The store holds copies of all that it makes nodes of: it outlives the call.
std::shared_ptr<const MapNodes> make_nodes(const MapInput& input, const std::vector<std::size_t>& keyframes,
                                           const calib::Rig& rig, const IcpConfig& icp, const MapConfig& config) {
  const PatchViewer viewer(rig.camera, rig.camera.width, rig.camera.height, config.view_stride_px);
  const auto make = [load = input.load, texture = input.texture, keyframes, viewer, icp, config](std::size_t k) {
    const SurfacePatch patch = load(keyframes[k]);
    MapNode node;
    node.samples = sample_patch(patch, config.sample_stride_px, icp.samples);
    node.reference = Reference(viewer(patch, Pose::Identity()), icp.reference);
    if (const auto picture = texture(keyframes[k])) {
      node.texture = texture_reference(*picture, Pose::Identity());
      node.texture_points = texture_points(patch, *node.texture, config.edge.texture);
    }
    return node;
  };
  auto nodes = std::make_shared<const MapNodes>(keyframes.size(), config.nodes_kept, make);
  input.for_each(std::min(nodes->size(), nodes->most_kept()), [&](std::size_t k) { (void)nodes->get(k); });
  return nodes;
}

/// Edges and what a bow of the rig makes of each.
struct Edges {
  std::vector<MapEdge> of;
  std::vector<EdgeBow> bows;
};

/// Both ways round: what one-sided association leaves of a bias has the other sign in the other.
Edges measure_edges(const MapInput& input, const std::vector<std::size_t>& keyframes,
                    const std::vector<KeyframePair>& pairs, const MapNodes& nodes, const BowMeasuring& with) {
  std::vector<std::optional<MapEdge>> found(2 * pairs.size());
  std::vector<EdgeBow> bows(found.size());
  const auto measure = [&](std::size_t n) {
    KeyframePair pair = pairs[n / 2];
    if (n % 2 == 1) std::swap(pair.i, pair.j);
    const Pose start =
        input.bursts[keyframes[pair.j]].T_model_cam.inverse() * input.bursts[keyframes[pair.i]].T_model_cam;
    const auto node_i = nodes.get(pair.i), node_j = nodes.get(pair.j);
    found[n] = measure_edge(*node_i, *node_j, with.rig.camera, start, with.icp, with.edge);
    if (!found[n]) return;
    found[n]->i = pair.i;
    found[n]->j = pair.j;
    found[n]->loop = pair.loop;
    bows[n] = measure_edge_bow(*node_i, *node_j, *found[n], with);
  };
  for (std::size_t part = 0; part < kParts; ++part) {
    const std::size_t from = part * found.size() / kParts, to = (part + 1) * found.size() / kParts;
    input.for_each(to - from, [&](std::size_t n) { measure(from + n); });
    input.progress(kNodesShare + kEdgesShare * static_cast<double>(part + 1) / kParts);
  }
  Edges out;
  for (std::size_t n = 0; n < found.size(); ++n) {
    if (!found[n]) continue;
    out.of.push_back(*found[n]);
    out.bows.push_back(bows[n]);
  }
  return out;
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
  const auto pairs = choose_pairs(input.bursts, keyframes, work_distance_mm, config);
  const auto nodes = make_nodes(input, keyframes, rig, icp, config);
  input.progress(kNodesShare);
  auto [edges, bows] = measure_edges(input, keyframes, pairs, *nodes, {rig, icp, config.edge, config.bow.edge});
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
