// Draws the 3-D part: backdrop, model, path, the probe's field, then light between the teeth and smooth edges.
#pragma once

#include <memory>
#include <optional>

#include "protocol/base/append_log.hpp"
#include "protocol/base/result.hpp"
#include "viewer/gl/line_pass.hpp"
#include "viewer/gl/model_pass.hpp"
#include "viewer/gl/render_target.hpp"
#include "viewer/scene/colour.hpp"
#include "viewer/scene/probe_field.hpp"
#include "viewer/scene/toggles.hpp"
#include "viewer/scene/view_camera.hpp"

namespace enamel::view {

/// What costs time: a software renderer draws the live window at kLive, pictures for files at kFine.
enum class Quality { kLive, kFine };

struct SceneView {
  ViewCamera camera;
  DisplayToggles toggles;
  ProbeField field;
  std::optional<Pose> T_model_cam;  ///< where the probe is drawn; empty: not drawn
  Colour probe_colour = kIdle;
  AppendLog<Vec3f>::View trail;
  float line_scale = 1;
};

class SceneRenderer {
 public:
  [[nodiscard]] static Result<std::unique_ptr<SceneRenderer>> make();

  [[nodiscard]] ModelPass& model() noexcept { return *model_; }

  /// Fills `out`. Errors: kDisplay when the driver refuses an intermediate picture.
  [[nodiscard]] Result<void> draw(const SceneView& view, Quality quality, const RenderTarget& out);

 private:
  SceneRenderer() = default;
  [[nodiscard]] Result<void> prepare_targets(const RenderTarget& out, Quality quality);
  void draw_probe(const SceneView& view, const LinePass::View& screen, float scale);
  void draw_trail(const SceneView& view, const LinePass::View& screen, float scale);
  void draw_occlusion(const ViewCamera& camera, double aspect);
  void compose(const RenderTarget& out, Quality quality);

  std::unique_ptr<ModelPass> model_;
  std::unique_ptr<LinePass> lines_;
  GlProgram backdrop_;
  GlProgram occlusion_;
  GlProgram darken_;
  GlProgram compose_;
  GlVertexArray screen_;
  std::optional<RenderTarget> scene_;
  std::optional<RenderTarget> shade_;
  LineBatch batch_;
};

}  // namespace enamel::view
