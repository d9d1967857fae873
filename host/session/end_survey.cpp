#include "host/session/end_survey.hpp"

#include <utility>

#include "host/session/read_ahead.hpp"

namespace enamel::host {

std::optional<SurveyResult> survey_model(const SurveyInput& input, Refined kept, stage::FuseStage& fuse) {
  const auto& history = kept.history;
  if (history.empty() || history.size() != input.placed.size() || input.mesh.vertices.empty()) return std::nullopt;
  Survey survey(input.mesh, input.rig.camera);
  ReadAhead<SurfacePatch> patches(history.size(), [&](std::size_t n) { return final_patch(kept, n, input.rig, fuse); });
  for (const MeasuredBurst& burst : input.placed) survey.add(patches.next(), burst.pose.T_model_cam, burst.sight);
  SurveyResult out = survey.result();
  const double pixel_mm = calib::middle_depth_mm(input.rig) / input.rig.camera.fx;
  out.passed_mm2 = kPassedStepPx * pixel_mm * kPassedStepPx * pixel_mm;
  out.passed = std::move(kept.passed);
  return out;
}

}  // namespace enamel::host
