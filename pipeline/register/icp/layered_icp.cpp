#include "pipeline/register/icp/layered_icp.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "pipeline/register/icp/layer_steps.hpp"

namespace enamel::pipeline {
namespace {

MatchGate gate_of(const MixedLayer& layer, const LayeredConfig& config) {
  const auto gate = static_cast<float>(layer.gate_mm);
  return {gate, gate, static_cast<float>(std::cos(layer.max_normal_deg * std::numbers::pi / 180)),
          static_cast<float>(config.hidden_mm)};
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
  fill_pyramid(patch, config.layers, config.samples, out);
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
      const RobustKernel kernel = kernel_of(config, last, scale_mm);
      const AlignPass pass = accumulate_mixed(of, {closest, layer.lambda}, out.T_model_cam, gate, kernel);
      if (pass.matches < config.min_matches / (l == 0 ? 4 : 1)) return out;
      const Vec3d centre = out.T_model_cam * samples.centroid;
      const Vector6 to_start = motion_between(out.T_model_cam, start, centre, config.rho_mm);
      const Solution step = solve(pass.system, to_start, config.prior);
      out.T_model_cam = apply_motion(step.x, centre, config.rho_mm, out.T_model_cam);
      note_step(pass, step, samples.size(), out);
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
