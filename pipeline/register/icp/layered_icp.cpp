#include "pipeline/register/icp/layered_icp.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace enamel::pipeline {
namespace {

MatchGate gate_of(const MixedLayer& layer, const LayeredConfig& config) {
  const auto gate = static_cast<float>(layer.gate_mm);
  return {gate, gate, static_cast<float>(std::cos(layer.max_normal_deg * std::numbers::pi / 180)),
          static_cast<float>(config.hidden_mm)};
}

/// Layered stop. last_rms 0: there is none yet.
bool layer_ends(const Vector6& step, double rms, double last_rms, const LayeredConfig& config) {
  const auto below = [&](double translation_mm, double rotation_rad) {
    return step.tail<3>().norm() < translation_mm && step.head<3>().norm() < rotation_rad * config.rho_mm;
  };
  if (below(config.end_translation_mm, config.end_rotation_rad)) return true;
  return std::abs(rms - last_rms) < config.rms_change * rms &&
         below(config.small_step_mm, config.small_step_mm / config.rho_mm);
}

void note(const AlignPass& pass, const Solution& step, std::size_t samples, IcpResult& out) {
  ++out.iterations;
  out.rms_mm = pass.rms_mm();
  out.overlap = static_cast<double>(pass.matches) / static_cast<double>(samples);
  out.consistency = static_cast<double>(pass.matches) / static_cast<double>(pass.matches + pass.contradictions);
  out.weak_directions = step.weak;
  out.eigenvalues = step.eigenvalues;
  out.system = pass.system;
}

}  // namespace

LayeredConfig published_layers() {
  LayeredConfig out;
  out.layers = {MixedLayer{8, 1.0, 45, 0.3, 10}, MixedLayer{4, 0.4, 35, 0.7, 8}, MixedLayer{2, 0.15, 30, 1, 6}};
  out.small_step_mm = std::numeric_limits<double>::infinity();
  return out;
}

LayeredConfig plain_point_to_plane(LayeredConfig config) {
  for (MixedLayer& layer : config.layers) layer.lambda = 1;
  return config;
}

PatchPyramid make_pyramid(const SurfacePatch& patch, const LayeredConfig& config) {
  PatchPyramid out;
  for (std::size_t l = 0; l < out.levels.size(); ++l) {
    out.levels[l] = sample_patch(patch, config.layers[l].stride_px, config.samples);
  }
  return out;
}

IcpResult align_layered(const PatchPyramid& patch, const Reference& reference, const ViewCamera& camera,
                        const Pose& start, const LayeredConfig& config) {
  IcpResult out;
  out.T_model_cam = start;
  if (reference.empty()) return out;
  const ClosestPoints closest(reference, camera, config.match);
  for (std::size_t l = 0; l < config.layers.size(); ++l) {
    const MixedLayer& layer = config.layers[l];
    const SampleSet& samples = patch.levels[l];
    const Alignment of{samples, reference, camera, config.rho_mm};
    const MatchGate gate = gate_of(layer, config);
    const bool last = l + 1 == config.layers.size();
    double scale_mm = layer.gate_mm / 3;
    double last_rms = 0;
    for (int k = 0; k < layer.max_iterations; ++k) {
      const double tuning = last ? config.welsch_scale : config.huber_scale;
      const RobustKernel kernel{last,
                                static_cast<float>(1 / (tuning * std::max(scale_mm, config.samples.sigma_floor_mm)))};
      const AlignPass pass = accumulate_mixed(of, {closest, layer.lambda}, out.T_model_cam, gate, kernel);
      if (pass.matches < config.min_matches / (l == 0 ? 4 : 1)) return out;
      const Vec3d centre = out.T_model_cam * samples.centroid;
      const Vector6 to_start = motion_between(out.T_model_cam, start, centre, config.rho_mm);
      const Solution step = solve(pass.system, to_start, config.prior);
      out.T_model_cam = apply_motion(step.x, centre, config.rho_mm, out.T_model_cam);
      note(pass, step, samples.size(), out);
      scale_mm = 1.4826 * pass.residuals.median_mm();
      if (layer_ends(step.x, out.rms_mm, last_rms, config)) break;
      last_rms = out.rms_mm;
    }
  }
  out.converged = true;
  out.undetermined = out.weak_directions;
  return out;
}

}  // namespace enamel::pipeline
