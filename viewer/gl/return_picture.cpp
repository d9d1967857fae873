#include "viewer/gl/return_picture.hpp"

#include "viewer/scene/follow_camera.hpp"

namespace enamel::view {

Result<void> ReturnPicture::update(const PreviewFrame& frame, const Style& style) {
  constexpr double kAspect = 4.0 / 3.0;
  const int height = static_cast<int>(style.width_px / kAspect);
  const auto camera = frame.whole ? overview(*frame.whole, kAspect) : std::nullopt;
  if (!camera || height < 1) {
    drawn_.reset();
    return {};
  }
  const bool fits = out_ && out_->width() == style.width_px;
  if (fits && drawn_ == frame.whole) {
    return {};
  }
  drawn_.reset();
  if (!scene_) {
    ENAMEL_TRY_ASSIGN(scene_, SceneRenderer::make());
  }
  if (!fits) {
    ENAMEL_TRY_ASSIGN(out_, RenderTarget::make(style.width_px, height, false));
  }
  scene_->model().update(*frame.whole, ~std::size_t{0});
  SceneView view;
  view.camera = *camera;
  view.toggles = style.toggles;
  view.toggles.frustum = true;
  view.field = style.field;
  view.probe_colour = kAccent;
  view.T_model_cam = frame.T_model_return;
  view.line_scale = style.scale;
  view.triangle_budget = DetailBudget::kSoftwareStart;  // small, and drawn once
  ENAMEL_TRY(scene_->draw(view, Quality::kLive, *out_));
  drawn_ = frame.whole;
  return {};
}

}  // namespace enamel::view
