#include "host/session/end_survey.hpp"

#include <future>
#include <utility>

namespace enamel::host {

std::optional<SurveyResult> survey_model(const SurveyInput& input, Refined kept, stage::FuseStage& fuse) {
  const auto& history = kept.history;
  if (history.empty() || history.size() != input.placed.size() || input.mesh.vertices.empty()) return std::nullopt;
  const auto load = [&](std::size_t n) {
    return std::async(std::launch::async,
                      [&, n] { return fuse.segments().patch_of(history[n], pipeline::Texture::kDropped); });
  };
  Survey survey(input.mesh, input.rig.camera);
  std::future<SurfacePatch> next = load(0);
  for (std::size_t n = 0; n < history.size(); ++n) {
    const SurfacePatch patch = next.get();
    if (n + 1 < history.size()) next = load(n + 1);
    survey.add(patch, input.placed[n].pose.T_model_cam, input.placed[n].sight);
  }
  SurveyResult out = survey.result();
  const double pixel_mm = calib::middle_depth_mm(input.rig) / input.rig.camera.fx;
  out.passed_mm2 = kPassedStepPx * pixel_mm * kPassedStepPx * pixel_mm;
  out.passed = std::move(kept.passed);
  return out;
}

}  // namespace enamel::host
