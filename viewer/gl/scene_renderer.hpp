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
  std::optional<Ball> focus;  ///< what is being scanned: drawn as fine as it is
  std::size_t triangle_budget = ~std::size_t{0};
  double sharpness = 1;  ///< of the picture's width and height, what draw() has the model drawn with at kLive
};

/// Whether both make the same picture of the same model, but for the budget and the sharpness.
[[nodiscard]] bool same_view(const SceneView& a, const SceneView& b);

class SceneRenderer {
 public:
  [[nodiscard]] static Result<std::unique_ptr<SceneRenderer>> make();

  [[nodiscard]] ModelPass& model() noexcept { return *model_; }

  /// Fills `out`. Errors: kDisplay when the driver refuses an intermediate picture.
  [[nodiscard]] Result<void> draw(const SceneView& view, Quality quality, const RenderTarget& out);

  /// One more part, of about view.triangle_budget triangles, of the picture that the mesh as it is and the full filter
  /// of edges make of the view that draw() had last, at kLive. Once finished() it is what `out` gets; until then what
  /// draw() made. Errors as draw().
  [[nodiscard]] Result<void> refine(const SceneView& view, const RenderTarget& out);
  [[nodiscard]] bool finished() const noexcept { return finished_; }
  /// What `out` had from draw() or refine() last.
  void compose_again(const RenderTarget& out);

 private:
  SceneRenderer() = default;
  [[nodiscard]] Result<void> prepare_targets(const RenderTarget& out, double scale, Quality quality);
  [[nodiscard]] Result<void> draw_backdrop(const RenderTarget& onto);
  void begin_scene(const RenderTarget& onto) const;
  void draw_lines(const SceneView& view, const RenderTarget& onto, const RenderTarget& out);
  void draw_probe(const SceneView& view, const LinePass::View& screen, float scale);
  void draw_trail(const SceneView& view, const LinePass::View& screen, float scale);
  void draw_occlusion(const ViewCamera& camera, double aspect);
  enum class Edges { kAsTheyAre, kQuick, kSmooth };
  void compose(const RenderTarget& scene, const RenderTarget& out, Edges edges);

  std::unique_ptr<ModelPass> model_;
  std::unique_ptr<LinePass> lines_;
  GlProgram backdrop_;
  GlProgram occlusion_;
  GlProgram darken_;
  GlProgram quick_compose_;
  GlProgram compose_;
  GlVertexArray screen_;
  std::optional<RenderTarget> scene_;
  std::optional<RenderTarget> shade_;
  std::optional<RenderTarget> still_;  ///< the mesh as it is, part by part
  std::optional<RenderTarget> backdrop_picture_;
  std::optional<std::size_t> next_part_;  ///< of still_; none: not begun, or finished
  bool finished_ = false;
  LineBatch batch_;
};

}  // namespace enamel::view
