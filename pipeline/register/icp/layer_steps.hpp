// What every ICP in layers does from step to step, whatever its metric. Config: IcpConfig or LayeredConfig, which name
// these numbers alike. Private to register/icp.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "pipeline/register/icp/accumulate.hpp"
#include "pipeline/register/icp/icp.hpp"

namespace enamel::pipeline {

/// finest: the last layer's kernel. scale_mm: robust standard deviation of the residuals.
template <class Config>
[[nodiscard]] RobustKernel kernel_of(const Config& config, bool finest, double scale_mm) {
  const double tuning = finest ? config.welsch_scale : config.huber_scale;
  return {finest, static_cast<float>(1 / (tuning * std::max(scale_mm, config.samples.sigma_floor_mm)))};
}

/// Layered stop: the residual hardly changes and the step is small, or the step is below two finer bounds. last_rms_mm
/// 0: there is none yet.
template <class Config>
[[nodiscard]] bool layer_ends(const Vector6& step, double rms_mm, double last_rms_mm, const Config& config) {
  const auto below = [&](double translation_mm, double rotation_rad) {
    return step.tail<3>().norm() < translation_mm && step.head<3>().norm() < rotation_rad * config.rho_mm;
  };
  if (below(config.end_translation_mm, config.end_rotation_rad)) return true;
  return std::abs(rms_mm - last_rms_mm) < config.rms_change * rms_mm &&
         below(config.small_step_mm, config.small_step_mm / config.rho_mm);
}

/// Samples of the patch at every layer's stride, into memory that is used again.
template <class Layers>
void fill_pyramid(const SurfacePatch& patch, const Layers& layers, const SampleConfig& samples, PatchPyramid& out) {
  sample_levels(patch, {layers[0].stride_px, layers[1].stride_px, layers[2].stride_px}, samples, out.levels);
}

/// What a pass and the step made of it say of the alignment.
inline void note_step(const AlignPass& pass, const Solution& step, std::size_t samples, IcpResult& out) {
  ++out.iterations;
  out.rms_mm = pass.rms_mm();
  out.overlap = static_cast<double>(pass.matches) / static_cast<double>(samples);
  out.consistency = static_cast<double>(pass.matches) / static_cast<double>(pass.matches + pass.contradictions);
  out.weak_directions = step.weak;
  out.eigenvalues = step.eigenvalues;
  out.system = pass.system;
}

}  // namespace enamel::pipeline
