#include "pipeline/register/stops/lay_stops.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "pipeline/register/stops/stop_pairs.hpp"

namespace enamel::pipeline {
namespace {

/// Both ways round, as in refine_map.
std::vector<MapEdge> measure_edges(const LayInput& input, const std::vector<StopPair>& pairs,
                                   const std::vector<Pose>& T_model_cam, const EdgeConfig& config) {
  std::vector<std::optional<MapEdge>> found(2 * pairs.size());
  input.for_each(found.size(), [&](std::size_t n) {
    std::size_t i = pairs[n / 2].i, j = pairs[n / 2].j;
    if (n % 2 == 1) std::swap(i, j);
    found[n] = measure_edge(input.taken.stops()[i].node, input.taken.stops()[j].node, input.rig.camera,
                            T_model_cam[j].inverse() * T_model_cam[i], input.icp, config);
    if (!found[n]) return;
    found[n]->i = i;
    found[n]->j = j;
    found[n]->loop = true;  // the axes hold every stop: any edge may be switched off
  });
  std::vector<MapEdge> edges;
  for (const auto& edge : found) {
    if (edge) edges.push_back(*edge);
  }
  return edges;
}

double rms_gap_mm(const std::vector<MapEdge>& edges, const std::vector<Pose>& T_model_cam) {
  double sum = 0;
  for (const MapEdge& edge : edges) sum += std::pow(edge_gap_mm(edge, T_model_cam), 2);
  return edges.empty() ? 0 : std::sqrt(sum / static_cast<double>(edges.size()));
}

/// Graph and lines by turns. Node 0 of the graph is the model's frame; stop k is node k + 1.
class Adjustment {
 public:
  Adjustment(const LayInput& input, const FollowedStops& followed, std::vector<MapEdge> edges, const LayConfig& config)
      : input_(input), followed_(followed), edges_(std::move(edges)), config_(config), mount_(input.mount) {
    for (MapEdge& edge : edges_) {
      ++edge.i;
      ++edge.j;
    }
  }

  [[nodiscard]] Pose told(std::size_t k) const {
    return pose_by_axes(mount_, input_.taken.stops()[k].angles, followed_.offsets[k]);
  }

  SolvedGraph run() {
    std::vector<Pose> start{Pose::Identity()};
    start.insert(start.end(), followed_.T_model_cam.begin(), followed_.T_model_cam.end());
    SolvedGraph solved = solve_graph(start, edges_, config_.graph, {}, priors());
    for (int round = 1; round < config_.rounds; ++round) {
      refit(solved.poses);
      solved = solve_graph(std::move(solved.poses), edges_, config_.graph, {}, priors());
    }
    return solved;
  }
  [[nodiscard]] const calib::Mount& mount() const { return mount_; }

  /// What is left of a stop beside its word, for people.
  [[nodiscard]] StopDeviation left_over(std::size_t k, const Pose& T) const {
    const Pose as_told = told(k);
    const Vec3d centre = as_told * input_.taken.stops()[k].centre;
    return take_apart(motion_between(as_told, T, centre, config_.graph.rho_mm), motions_of(k, centre));
  }

 private:
  [[nodiscard]] AxisMotions motions_of(std::size_t k, const Vec3d& centre) const {
    return axis_motions(mount_, input_.taken.stops()[k].angles, followed_.offsets[k], centre, config_.graph.rho_mm);
  }

  [[nodiscard]] std::vector<PosePrior> priors() const {
    std::vector<PosePrior> out;
    for (std::size_t k = 0; k < input_.taken.stops().size(); ++k) {
      const Pose T = told(k);
      const Vec3d centre = T * input_.taken.stops()[k].centre;
      const Matrix6 C = pose_covariance(motions_of(k, centre), config_.stop, config_.graph.rho_mm);
      out.push_back({k + 1, T, centre, C.ldlt().solve(Matrix6::Identity())});
    }
    return out;
  }

  void refit(const std::vector<Pose>& poses) {
    std::vector<StopPose> seen;
    for (std::size_t k = 0; k < input_.taken.stops().size(); ++k) {
      if (followed_.laid[k] == Laid::kNot || !followed_.offsets[k].is_of_angles_only()) continue;
      seen.push_back({turned_by(input_.taken.stops()[k].angles, followed_.offsets[k]), poses[k + 1],
                      poses[k + 1] * input_.taken.stops()[k].centre});
    }
    mount_ = refit_mount(input_.mount, seen, config_.lines, config_.stop, config_.graph.rho_mm);
  }

  const LayInput& input_;
  const FollowedStops& followed_;
  std::vector<MapEdge> edges_;
  const LayConfig& config_;
  calib::Mount mount_;
};

}  // namespace

PatchViewer stop_viewer(const calib::LensValues& lens, const LayConfig& config) {
  return {lens, lens.width, lens.height, config.view_stride_px};
}

Stop make_stop(const SurfacePatch& patch, const calib::AxisAngles& angles, const PatchViewer& viewer,
               const IcpConfig& icp, const LayConfig& config) {
  Stop out;
  out.angles = angles;
  out.node.samples = sample_patch(patch, config.sample_stride_px, icp.samples);
  out.node.reference = Reference(viewer(patch, Pose::Identity()), icp.reference);
  out.pyramid = make_pyramid(patch, config.slip.layered);
  out.centre = out.node.samples.centroid;
  return out;
}

LaidStops lay_stops(const LayInput& input, const LayConfig& config) {
  const FollowedStops& followed = input.taken.followed();
  std::vector<StopPair> pairs =
      overlapping_pairs(input.taken.stops(), followed.T_model_cam, ViewCamera(input.rig.camera), config.overlap_gate_mm,
                        config.min_overlap);
  std::erase_if(pairs, [&](const StopPair& pair) {
    return followed.laid[pair.i] == Laid::kNot || followed.laid[pair.j] == Laid::kNot;
  });
  const std::vector<MapEdge> edges = measure_edges(input, pairs, followed.T_model_cam, config.edge);
  Adjustment adjustment(input, followed, edges, config);
  const SolvedGraph solved = adjustment.run();
  LaidStops out;
  out.by_axes = followed.T_model_cam;
  out.T_model_cam.assign(solved.poses.begin() + 1, solved.poses.end());
  out.laid = followed.laid;
  out.slips = followed.slips;
  for (std::size_t k = 0; k < input.taken.stops().size(); ++k)
    out.corrections.push_back(adjustment.left_over(k, out.T_model_cam[k]));
  out.mount = adjustment.mount();
  out.pairs = pairs.size();
  out.edges = edges.size();
  out.switched_off = solved.switched_off;
  out.sigma0 = solved.sigma0;
  out.coarse_rms_mm = rms_gap_mm(edges, out.by_axes);
  out.fine_rms_mm = rms_gap_mm(edges, out.T_model_cam);
  out.circles = find_circles(input.taken.stops(), edges, out.by_axes, out.T_model_cam);
  return out;
}

}  // namespace enamel::pipeline
