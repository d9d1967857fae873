#include "pipeline/register/stops/slip_search.hpp"

#include <cmath>

namespace enamel::pipeline {
namespace {

/// 0, +1, -1, +2, -2 … steps, up to `most`.
std::vector<double> outwards(double step, double most) {
  std::vector<double> out;
  for (int k = 1; k * step <= most * (1 + 1e-9); ++k) {
    out.push_back(k * step);
    out.push_back(-k * step);
  }
  return out;
}

}  // namespace

std::vector<Pose> starts_about(const Pose& T, const Vec3d& centre, const AxisMotions& motions, double rho_mm,
                               const SlipConfig& config) {
  std::vector<Pose> out{T};
  for (const double deg : outwards(config.search_step_deg, config.search_deg)) {
    const double rad = deg * calib::kRadPerDegree;
    out.push_back(apply_motion(rad * motions.rotation, centre, rho_mm, T));
    out.push_back(apply_motion(rad * motions.swing, centre, rho_mm, T));
  }
  // The table's plane is square to the rotation axis.
  const Vec3d axis = motions.rotation.head<3>().normalized();
  const Vec3d along = axis.unitOrthogonal(), across = axis.cross(along);
  std::vector<double> steps = outwards(config.search_step_mm, config.search_mm);
  steps.push_back(0);
  for (const double a : steps) {
    for (const double b : steps) {
      if (a == 0 && b == 0) continue;
      Vector6 x = Vector6::Zero();
      x.tail<3>() = a * along + b * across;
      out.push_back(apply_motion(x, centre, rho_mm, T));
    }
  }
  return out;
}

std::optional<Pose> lay_from_afar(const Stop& i, const Stop& j, const Pose& T_model_j, const std::vector<Pose>& starts,
                                  const LayingRules& with, const SlipConfig& config) {
  const Pose T_j_model = T_model_j.inverse();
  std::optional<Pose> best;
  double best_score = 0;
  for (const Pose& start : starts) {
    const Pose T_j_i = T_j_model * start;
    const IcpResult laid = align_layered(i.pyramid, j.node.reference, ViewCamera(with.lens), T_j_i, config.layered);
    if (!laid.converged || laid.consistency < config.min_consistency || laid.overlap < with.edge.min_overlap) continue;
    if (laid.rms_mm > with.edge.max_rms_mm) continue;
    const double score = laid.consistency * laid.overlap / std::max(laid.rms_mm, 1e-4);
    if (score <= best_score) continue;
    best_score = score;
    best = T_model_j * laid.T_model_cam;
  }
  return best;
}

}  // namespace enamel::pipeline
