#include "calib/judge/step_effect.hpp"

#include <cmath>

namespace enamel::calib {
namespace {

/// The bow or twist that is largest, with its standard error.
void take_largest(const std::array<DepthShape, 3>& shapes, StepEffect& effect) {
  for (const DepthShape& s : shapes) {
    for (const auto part : {&PlaneShape::sag_x_um, &PlaneShape::sag_y_um, &PlaneShape::twist_um}) {
      if (std::abs(s.shape.*part) < effect.sag_um) continue;
      effect.sag_um = std::abs(s.shape.*part);
      effect.sag_sigma_um = s.sigma.*part;
    }
  }
}

StepEffect effect_of(const SolveStep& step, const std::vector<PoseView>& views, const TargetDesign& target,
                     const Ripple& ripple, DepthRange range) {
  StepEffect effect{.step = step.name};
  std::vector<PlaneCheck> planes;
  double squares = 0;
  for (const PoseView& view : views) {
    auto plane = check_plane(view, target, step.state, ripple);
    if (!plane) continue;
    const double points = static_cast<double>(plane->points);
    squares += points * plane->rms_um * plane->rms_um;
    effect.points += plane->points;
    effect.plane_p95_um += plane->p95_um;
    planes.push_back(std::move(*plane));
  }
  if (planes.empty()) return effect;
  const double points = static_cast<double>(effect.points);
  effect.plane_rms_um = std::sqrt(squares / points);
  effect.plane_rms_sigma_um = effect.plane_rms_um / std::sqrt(2 * points);
  effect.plane_p95_um /= static_cast<double>(planes.size());
  take_largest(shapes_over_depth(planes, range), effect);
  return effect;
}

}  // namespace

std::vector<StepEffect> step_effects(const Solution& solution, const std::vector<PoseView>& views,
                                     const TargetDesign& target, const Ripple& ripple, DepthRange range) {
  std::vector<StepEffect> out;
  for (const SolveStep& step : solution.steps) out.push_back(effect_of(step, views, target, ripple, range));
  return out;
}

}  // namespace enamel::calib
