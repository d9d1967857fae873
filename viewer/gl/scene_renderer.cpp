#include "viewer/gl/scene_renderer.hpp"

#include <cmath>

#include "viewer/gl/shader.hpp"

namespace enamel::view {
namespace {

constexpr int kFineScale = 2;  ///< four scene pixels under each pixel of a fine picture

void bind_texture(int unit, GLuint texture) {
  glActiveTexture(static_cast<GLenum>(GL_TEXTURE0 + unit));
  glBindTexture(GL_TEXTURE_2D, texture);
  glActiveTexture(GL_TEXTURE0);
}

Eigen::Vector2f size_of(const RenderTarget& target) {
  return {static_cast<float>(target.width()), static_cast<float>(target.height())};
}

}  // namespace

Result<std::unique_ptr<SceneRenderer>> SceneRenderer::make() {
  std::unique_ptr<SceneRenderer> out(new SceneRenderer);
  ENAMEL_TRY_ASSIGN(out->model_, ModelPass::make());
  ENAMEL_TRY_ASSIGN(out->lines_, LinePass::make());
  ENAMEL_TRY_ASSIGN(out->backdrop_, build_program("backdrop", glsl::kScreenVertex, glsl::kBackdropFragment));
  ENAMEL_TRY_ASSIGN(out->occlusion_, build_program("occlusion", glsl::kScreenVertex, glsl::kOcclusionFragment));
  ENAMEL_TRY_ASSIGN(out->darken_, build_program("darken", glsl::kScreenVertex, glsl::kDarkenFragment));
  ENAMEL_TRY_ASSIGN(out->compose_, build_program("compose", glsl::kScreenVertex, glsl::kComposeFragment));
  out->screen_ = GlVertexArray::make();
  return out;
}

Result<void> SceneRenderer::prepare_targets(const RenderTarget& out, Quality quality) {
  const int scale = quality == Quality::kFine ? kFineScale : 1;
  const int width = out.width() * scale;
  const int height = out.height() * scale;
  if (!scene_ || scene_->width() != width || scene_->height() != height) {
    scene_.reset();
    shade_.reset();
    ENAMEL_TRY_ASSIGN(scene_, RenderTarget::make(width, height, true));
  }
  if (quality == Quality::kFine && !shade_) {
    ENAMEL_TRY_ASSIGN(shade_, RenderTarget::make(width, height, false));
  }
  return {};
}

Result<void> SceneRenderer::draw(const SceneView& view, Quality quality, const RenderTarget& out) {
  ENAMEL_TRY(prepare_targets(out, quality));
  const double aspect = static_cast<double>(out.width()) / out.height();
  const float scale = view.line_scale * static_cast<float>(scene_->width()) / static_cast<float>(out.width());
  const LinePass::View screen{projection_matrix(view.camera, aspect) * view_matrix(view.camera), scene_->width(),
                              scene_->height()};
  scene_->bind();
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_DEPTH_TEST);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  glDepthMask(GL_TRUE);
  glClearDepth(1.0);
  glClear(GL_DEPTH_BUFFER_BIT);
  glUseProgram(backdrop_.id());
  set_uniform(backdrop_, "aspect", static_cast<float>(aspect));
  glBindVertexArray(screen_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);

  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  model_->draw(view.camera, aspect, scene_->height(), view.toggles);
  if (quality == Quality::kFine) {
    draw_occlusion(view.camera, aspect);
  }
  draw_trail(view, screen, scale);
  draw_probe(view, screen, scale);
  compose(out, quality);
  return {};
}

void SceneRenderer::draw_trail(const SceneView& view, const LinePass::View& screen, float scale) {
  if (!view.toggles.trail || view.trail.size() < 2) {
    return;
  }
  batch_.clear();
  const auto n = static_cast<float>(view.trail.size());
  float points_after = 0;
  const Vec3f* after = nullptr;
  view.trail.newest_first([&](const Vec3f& point) {
    if (after != nullptr && after->allFinite() && point.allFinite()) {  // the newest part is brightest
      const Tint tint{kAccent, 0.85F - 0.55F * points_after / n};
      batch_.line(point, *after, tint, tint);
    }
    after = &point;
    ++points_after;
  });
  lines_->draw(batch_, screen, 1.6F * scale, 0.75F, 0.12F);
}

void SceneRenderer::draw_probe(const SceneView& view, const LinePass::View& screen, float scale) {
  if (!view.toggles.frustum || !view.T_model_cam) {
    return;
  }
  const FrustumGeometry shape = frustum(view.field, *view.T_model_cam);
  const auto at = [&shape](int i) -> const Vec3f& { return shape.points[static_cast<std::size_t>(i)]; };
  batch_.clear();
  for (const auto& side : FrustumGeometry::kSides) {
    batch_.triangle(at(side[0]), at(side[1]), at(side[2]), {view.probe_colour, 1});
    batch_.triangle(at(side[0]), at(side[2]), at(side[3]), {view.probe_colour, 1});
  }
  lines_->draw(batch_, screen, 0, 0.045F, 0);
  batch_.clear();
  for (const auto& edge : FrustumGeometry::kEdges) {
    batch_.line(at(edge[0]), at(edge[1]), {view.probe_colour, 1}, {view.probe_colour, 1});
  }
  for (const auto& edge : FrustumGeometry::kApexEdges) {  // towards the probe's window, fading
    const Vec3f part = at(edge[1]) + 0.45F * (at(edge[0]) - at(edge[1]));
    batch_.line(at(edge[1]), part, {view.probe_colour, 0.55F}, {view.probe_colour, 0});
  }
  lines_->draw(batch_, screen, 1.5F * scale, 0.8F, 0.2F);
}

void SceneRenderer::draw_occlusion(const ViewCamera& camera, double aspect) {
  shade_->bind();
  glDisable(GL_DEPTH_TEST);
  glUseProgram(occlusion_.id());
  const Eigen::Matrix4f projection = projection_matrix(camera, aspect);
  set_uniform(occlusion_, "projection", projection);
  set_uniform(occlusion_, "unprojection", Eigen::Matrix4f(projection.cast<double>().inverse().cast<float>()));
  set_uniform(occlusion_, "radius_mm", 2.6F);
  set_uniform(occlusion_, "depth", 0);
  bind_texture(0, scene_->depth());
  glBindVertexArray(screen_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);

  scene_->bind();
  glUseProgram(darken_.id());
  set_uniform(darken_, "occlusion", 0);
  set_uniform(darken_, "scene_px", size_of(*scene_));
  bind_texture(0, shade_->colour());
  glEnable(GL_BLEND);
  glBlendFunc(GL_DST_COLOR, GL_ZERO);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
}

void SceneRenderer::compose(const RenderTarget& out, Quality quality) {
  out.bind();
  glDisable(GL_DEPTH_TEST);
  glUseProgram(compose_.id());
  set_uniform(compose_, "scene", 0);
  set_uniform(compose_, "smooth_edges", quality == Quality::kFine ? 0.0F : 1.0F);
  set_uniform(compose_, "scene_px", size_of(*scene_));
  bind_texture(0, scene_->colour());
  glBindVertexArray(screen_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  bind_texture(0, 0);
  glBindVertexArray(0);
}

}  // namespace enamel::view
