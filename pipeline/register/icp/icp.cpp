#include "pipeline/register/icp/icp.hpp"

#include <cmath>
#include <numbers>

#include "pipeline/register/icp/layer_steps.hpp"

namespace enamel::pipeline {
namespace {

MatchGate make_gate(const IcpLevel& level, const IcpConfig& config) {
  // The nearest pixel of the reference lies beside the point, not only above it: allow for its pitch.
  return {static_cast<float>(level.gate_mm), static_cast<float>(level.gate_mm + 0.1),
          static_cast<float>(std::cos(level.max_normal_deg * std::numbers::pi / 180)),
          static_cast<float>(config.hidden_mm)};
}

}  // namespace

PatchPyramid make_pyramid(const SurfacePatch& patch, const IcpConfig& config) {
  PatchPyramid out;
  make_pyramid(patch, config, out);
  return out;
}

void make_pyramid(const SurfacePatch& patch, const IcpConfig& config, PatchPyramid& out) {
  fill_pyramid(patch, config.levels, config.samples, out);
}

IcpResult align(const PatchPyramid& patch, const Reference& reference, const ViewCamera& camera, const Pose& start,
                const Pose& prior, const IcpConfig& config) {
  IcpResult out;
  out.T_model_cam = start;
  if (reference.empty()) return out;
  for (std::size_t l = 0; l < config.levels.size(); ++l) {
    const IcpLevel& level = config.levels[l];
    const SampleSet& samples = patch.levels[l];
    const Alignment of{samples, reference, camera, config.rho_mm};
    const MatchGate gate = make_gate(level, config);
    double scale = level.gate_mm / 3;
    double last_rms = 0;
    for (int k = 0; k < level.max_iterations; ++k) {
      const AlignPass pass =
          accumulate(of, out.T_model_cam, gate, kernel_of(config, l + 1 == config.levels.size(), scale));
      if (pass.matches < config.min_matches / (l == 0 ? 4 : 1)) return out;
      const Vec3d centre = out.T_model_cam * samples.centroid;
      const Vector6 to_prior = motion_between(out.T_model_cam, prior, centre, config.rho_mm);
      const Solution step = solve(pass.system, to_prior, config.prior);
      out.T_model_cam = apply_motion(step.x, centre, config.rho_mm, out.T_model_cam);
      note_step(pass, step, samples.size(), out);
      scale = 1.4826 * pass.residuals.median_mm();
      if (layer_ends(step.x, out.rms_mm, last_rms, config)) break;
      last_rms = out.rms_mm;
    }
  }
  out.converged = true;
  out.undetermined = out.weak_directions;
  return out;
}

}  // namespace enamel::pipeline
