#include "pipeline/register/map/map_edge.hpp"

#include <cmath>
#include <numbers>

#include "pipeline/register/icp/accumulate.hpp"

namespace enamel::pipeline {
namespace {

struct Laying {
  const MapNode& i;
  const MapNode& j;
  const calib::LensValues& lens;
  const IcpConfig& icp;
  const EdgeConfig& config;
};

struct ByShape {
  MapEdge edge;
  WeakDirections weak;  ///< along which it says nothing
};

std::optional<ByShape> measure_by_shape(const Laying& of, const Pose& start, double first_gate_mm, int rounds) {
  const SampleSet& samples = of.i.samples;
  const ViewCamera camera(of.lens);
  const Alignment alignment{samples, of.j.reference, camera, of.icp.rho_mm};
  MatchGate gate{static_cast<float>(first_gate_mm), static_cast<float>(first_gate_mm + 0.1),
                 static_cast<float>(std::cos(of.config.max_normal_deg * std::numbers::pi / 180)),
                 static_cast<float>(of.icp.hidden_mm)};
  double scale = first_gate_mm / 3;
  ByShape out;
  out.edge.T_j_i = start;
  for (int round = 0; round < rounds; ++round) {
    const RobustKernel kernel{
        true, static_cast<float>(1 / (of.icp.welsch_scale * std::max(scale, of.icp.samples.sigma_floor_mm)))};
    const AlignPass pass = accumulate(alignment, out.edge.T_j_i, gate, kernel);
    if (pass.matches < of.icp.min_matches) return std::nullopt;
    const auto matches = static_cast<double>(pass.matches);
    if (matches / static_cast<double>(samples.size()) < of.config.min_overlap) return std::nullopt;
    out.edge.centre = out.edge.T_j_i * samples.centroid;
    const Solution step = solve(pass.system, Vector6::Zero(), of.icp.prior);
    out.edge.H = pass.system.H;
    out.edge.T_j_i = apply_motion(step.x, out.edge.centre, of.icp.rho_mm, out.edge.T_j_i);
    scale = 1.4826 * pass.residuals.median_mm();
    gate.distance_mm = static_cast<float>(of.config.gate_mm);
    if (round + 1 < rounds) continue;
    const double consistency = matches / (matches + static_cast<double>(pass.contradictions));
    if (consistency < of.config.min_consistency || pass.rms_mm() > of.config.max_rms_mm) return std::nullopt;
    out.weak = weak_directions(pass.system, of.icp.prior.weak_eigenvalue);
  }
  return out;
}

}  // namespace

std::optional<MapEdge> measure_edge(const MapNode& i, const MapNode& j, const calib::LensValues& lens,
                                    const Pose& start, const IcpConfig& icp, const EdgeConfig& config) {
  if (i.samples.size() == 0 || j.reference.empty()) return std::nullopt;
  const Laying of{i, j, lens, icp, config};
  auto found = measure_by_shape(of, start, config.first_gate_mm, config.rounds);
  if (!found) return std::nullopt;
  if (found->weak.cols() == 0 || !j.texture) return found->edge;
  for (int turn = 0; turn < config.texture_turns; ++turn) {
    const MapEdge& edge = found->edge;
    const auto hold = hold_by_texture({i.texture_points, *j.texture, lens, edge.centre, icp.rho_mm}, edge.T_j_i,
                                      found->weak, config.texture);
    if (!hold) return edge;
    const Pose told = apply_motion(hold->x, edge.centre, icp.rho_mm, edge.T_j_i);
    auto again = measure_by_shape(of, told, config.gate_mm, 2);
    if (!again) return edge;
    found = std::move(again);
    found->edge.H_texture = hold->H;
  }
  return found->edge;
}

}  // namespace enamel::pipeline
