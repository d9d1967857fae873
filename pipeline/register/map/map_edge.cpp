#include "pipeline/register/map/map_edge.hpp"

#include <cmath>
#include <numbers>

#include "pipeline/register/icp/accumulate.hpp"

namespace enamel::pipeline {

std::optional<MapEdge> measure_edge(const MapNode& i, const MapNode& j, const ViewCamera& camera, const Pose& start,
                                    const IcpConfig& icp, const EdgeConfig& config) {
  if (i.samples.size() == 0 || j.reference.empty()) return std::nullopt;
  const Alignment of{i.samples, j.reference, camera, icp.rho_mm};
  MatchGate gate{static_cast<float>(config.first_gate_mm), static_cast<float>(config.first_gate_mm + 0.1),
                 static_cast<float>(std::cos(config.max_normal_deg * std::numbers::pi / 180)),
                 static_cast<float>(icp.hidden_mm)};
  double scale = config.first_gate_mm / 3;
  MapEdge edge;
  edge.T_j_i = start;
  for (int round = 0; round < config.rounds; ++round) {
    const RobustKernel kernel{true,
                              static_cast<float>(1 / (icp.welsch_scale * std::max(scale, icp.samples.sigma_floor_mm)))};
    const AlignPass pass = accumulate(of, edge.T_j_i, gate, kernel);
    if (pass.matches < icp.min_matches) return std::nullopt;
    const double overlap = static_cast<double>(pass.matches) / static_cast<double>(i.samples.size());
    const double consistency =
        static_cast<double>(pass.matches) / static_cast<double>(pass.matches + pass.contradictions);
    if (overlap < config.min_overlap) return std::nullopt;
    edge.centre = edge.T_j_i * i.samples.centroid;
    const Solution step = solve(pass.system, Vector6::Zero(), icp.prior);
    edge.H = pass.system.H;
    edge.T_j_i = apply_motion(step.x, edge.centre, icp.rho_mm, edge.T_j_i);
    scale = 1.4826 * pass.residuals.median_mm();
    gate.distance_mm = static_cast<float>(config.gate_mm);
    if (round + 1 < config.rounds) continue;
    if (consistency < config.min_consistency || pass.rms_mm() > config.max_rms_mm) return std::nullopt;
  }
  return edge;
}

}  // namespace enamel::pipeline
