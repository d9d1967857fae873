#include "tools/twin/board/board_stage.hpp"

#include <algorithm>
#include <utility>

#include "tools/twin/board/board_poses.hpp"
#include "tools/twin/mount/mount_path.hpp"

namespace enamel::twin {
namespace {

/// A probe exposes for what it is shown: a scene that exposes for teeth does not blind it before a board.
RenderConfig board_render(const SceneConfig& c) {
  RenderConfig r = effective_render(c);
  r.light.reference_fraction = std::min(r.light.reference_fraction, LightConfig{}.reference_fraction);
  return r;
}

}  // namespace

BoardStage::BoardStage(const SceneConfig& c, const calib::Rig& rig)
    : instrument_(rig, effective_projector(c)),
      scene_(make_dot_board(c.board, c.seed)),
      renderer_(instrument_, scene_, board_render(c)),
      sensor_(effective_sensor(c, *rig.noise)),
      patterns_(rig, c.calibration.cycles, c.calibration.mean, c.calibration.amplitude) {
  const calib::DepthRange range = rig.depth_range.value_or(calib::DepthRange{40, 56});
  for (int set = 0; set < patterns_.sets(); ++set)
    lights_.emplace_back(patterns_.levels(set), effective_projector(c), range.near_mm, range.far_mm);
}

Result<std::unique_ptr<BoardStage>> BoardStage::create(const SceneConfig& scene) {
  if (scene.rig_path.empty()) return fail(ErrorCode::kRigMissing, "the scene names no rig");
  ENAMEL_TRY_ASSIGN(const calib::Rig loaded, calib::load_rig(scene.rig_path));
  ENAMEL_TRY_ASSIGN(const calib::Rig rig, apply_effects(loaded, scene.effects));
  if (!rig.noise) return fail(ErrorCode::kRigInvalid, "the twin needs `noise` in the rig");
  std::unique_ptr<BoardStage> stage(new BoardStage(scene, rig));
  if (scene.path == PathKind::kMount) {
    stage->stands_ = mount_poses(drive(scene.mount, scene.seed));
    return stage;
  }
  ENAMEL_TRY_ASSIGN(stage->stands_, board_poses(stage->instrument_, scene.board, scene.calibration.poses, scene.seed));
  return stage;
}

std::array<std::vector<float>, 4> BoardStage::electrons(const StillView& view, int set) const {
  auto frames = StillRenderer::shade(view, lights_[static_cast<std::size_t>(set)]);
  const auto full_well = static_cast<float>(sensor_.full_well_e);
  for (auto& image : frames) {
    apply_psf(image, rig().camera.width, rig().camera.height, sensor_.psf_sigma_px);
    for (float& e : image) e *= full_well;
  }
  return frames;
}

}  // namespace enamel::twin
