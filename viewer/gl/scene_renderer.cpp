#include "viewer/gl/scene_renderer.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "viewer/gl/shader.hpp"

namespace enamel::view {
namespace {

constexpr double kFineScale = 2;  ///< four scene pixels under each pixel of a fine picture

void bind_texture(int unit, GLuint texture) {
  glActiveTexture(static_cast<GLenum>(GL_TEXTURE0 + unit));
  glBindTexture(GL_TEXTURE_2D, texture);
  glActiveTexture(GL_TEXTURE0);
}

Eigen::Vector2f size_of(const RenderTarget& target) {
  return {static_cast<float>(target.width()), static_cast<float>(target.height())};
}

void copy(const RenderTarget& from, const RenderTarget& to, GLenum filter) {
  glDisable(GL_SCISSOR_TEST);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, from.framebuffer());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, to.framebuffer());
  glBlitFramebuffer(0, 0, from.width(), from.height(), 0, 0, to.width(), to.height(), GL_COLOR_BUFFER_BIT, filter);
}

bool has_size(const std::optional<RenderTarget>& target, int width, int height) {
  return target && target->width() == width && target->height() == height;
}

bool same_camera(const ViewCamera& a, const ViewCamera& b) {
  return a.target == b.target && a.R_model_view.coeffs() == b.R_model_view.coeffs() && a.distance_mm == b.distance_mm &&
         a.fov_y_rad == b.fov_y_rad;
}

bool same_probe(const SceneView& a, const SceneView& b) {
  if (a.T_model_cam.has_value() != b.T_model_cam.has_value() || a.probe_colour != b.probe_colour) return false;
  return (!a.T_model_cam || a.T_model_cam->matrix() == b.T_model_cam->matrix()) &&
         a.field.corner_rays == b.field.corner_rays && a.field.near_mm == b.field.near_mm &&
         a.field.far_mm == b.field.far_mm;
}

}  // namespace

bool same_view(const SceneView& a, const SceneView& b) {
  const auto shown = [](const SceneView& v) {
    const DisplayToggles& t = v.toggles;
    return std::tuple(t.quality_map, t.mono, t.soft_tissue, t.frustum, t.trail, v.line_scale, v.trail.size());
  };
  return same_camera(a.camera, b.camera) && same_probe(a, b) && shown(a) == shown(b);
}

Result<std::unique_ptr<SceneRenderer>> SceneRenderer::make() {
  std::unique_ptr<SceneRenderer> out(new SceneRenderer);
  ENAMEL_TRY_ASSIGN(out->model_, ModelPass::make());
  ENAMEL_TRY_ASSIGN(out->lines_, LinePass::make());
  ENAMEL_TRY_ASSIGN(out->backdrop_, build_program("backdrop", glsl::kScreenVertex, glsl::kBackdropFragment));
  ENAMEL_TRY_ASSIGN(out->occlusion_, build_program("occlusion", glsl::kScreenVertex, glsl::kOcclusionFragment));
  ENAMEL_TRY_ASSIGN(out->darken_, build_program("darken", glsl::kScreenVertex, glsl::kDarkenFragment));
  ENAMEL_TRY_ASSIGN(out->quick_compose_, build_program("quick compose", glsl::kScreenVertex, glsl::kQuickCompose));
  ENAMEL_TRY_ASSIGN(out->compose_, build_program("compose", glsl::kScreenVertex, glsl::kComposeFragment));
  out->screen_ = GlVertexArray::make();
  return out;
}

Result<void> SceneRenderer::prepare_targets(const RenderTarget& out, double scale, Quality quality) {
  const int width = std::max(1, static_cast<int>(std::lround(out.width() * scale)));
  const int height = std::max(1, static_cast<int>(std::lround(out.height() * scale)));
  if (!has_size(scene_, width, height)) {
    scene_.reset();
    shade_.reset();
    ENAMEL_TRY_ASSIGN(scene_, RenderTarget::make(width, height, true));
  }
  if (quality == Quality::kFine && !shade_) {
    ENAMEL_TRY_ASSIGN(shade_, RenderTarget::make(width, height, false));
  }
  return {};
}

/// The same for every view: drawn once a size.
Result<void> SceneRenderer::draw_backdrop(const RenderTarget& onto) {
  if (!backdrop_picture_ || backdrop_picture_->width() != onto.width() ||
      backdrop_picture_->height() != onto.height()) {
    backdrop_picture_.reset();
    ENAMEL_TRY_ASSIGN(backdrop_picture_, RenderTarget::make(onto.width(), onto.height(), false));
    backdrop_picture_->bind();
    glDisable(GL_DEPTH_TEST);
    glUseProgram(backdrop_.id());
    set_uniform(backdrop_, "aspect", static_cast<float>(onto.width()) / static_cast<float>(onto.height()));
    glBindVertexArray(screen_.id());
    glDrawArrays(GL_TRIANGLES, 0, 3);
  }
  copy(*backdrop_picture_, onto, GL_NEAREST);
  return {};
}

void SceneRenderer::begin_scene(const RenderTarget& onto) const {
  onto.bind();
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  glDisable(GL_SCISSOR_TEST);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
}

void SceneRenderer::draw_lines(const SceneView& view, const RenderTarget& onto, const RenderTarget& out) {
  const double aspect = static_cast<double>(out.width()) / out.height();
  const float scale = view.line_scale * static_cast<float>(onto.width()) / static_cast<float>(out.width());
  const LinePass::View screen{projection_matrix(view.camera, aspect) * view_matrix(view.camera), onto.width(),
                              onto.height()};
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_FALSE);  // brightness stays the model's: lines have soft edges already
  draw_trail(view, screen, scale);
  draw_probe(view, screen, scale);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

Result<void> SceneRenderer::draw(const SceneView& view, Quality quality, const RenderTarget& out) {
  ENAMEL_TRY(prepare_targets(out, quality == Quality::kFine ? kFineScale : view.sharpness, quality));
  const double aspect = static_cast<double>(out.width()) / out.height();
  begin_scene(*scene_);
  ENAMEL_TRY(draw_backdrop(*scene_));
  begin_scene(*scene_);
  glClearDepth(1.0);
  glClear(GL_DEPTH_BUFFER_BIT);
  model_->draw({view.camera, aspect, scene_->height(), view.focus}, view.toggles, view.triangle_budget);
  if (quality == Quality::kFine) {
    draw_occlusion(view.camera, aspect);
  }
  draw_lines(view, *scene_, out);
  next_part_.reset();
  finished_ = false;
  compose_again(out);
  return {};
}

Result<void> SceneRenderer::refine(const SceneView& view, const RenderTarget& out) {
  if (!has_size(still_, out.width(), out.height())) {
    still_.reset();
    next_part_.reset();
    ENAMEL_TRY_ASSIGN(still_, RenderTarget::make(out.width(), out.height(), true));
  }
  const double aspect = static_cast<double>(out.width()) / out.height();
  if (!next_part_) {
    begin_scene(*still_);
    ENAMEL_TRY(draw_backdrop(*still_));
    begin_scene(*still_);
    glClearDepth(1.0);
    glClear(GL_DEPTH_BUFFER_BIT);
  }
  begin_scene(*still_);
  model_->draw_exact({view.camera, aspect, still_->height(), view.focus}, view.toggles, next_part_,
                     view.triangle_budget);
  finished_ = !next_part_;
  if (finished_) {
    draw_lines(view, *still_, out);
    compose_again(out);
  }
  return {};
}

void SceneRenderer::compose_again(const RenderTarget& out) {
  if (finished_) {
    compose(*still_, out, Edges::kSmooth);
  } else if (scene_->width() < out.width()) {
    copy(*scene_, out, GL_LINEAR);  // a software renderer's textures, filtered by a shader, take four times as long
  } else {
    compose(*scene_, out, scene_->width() == out.width() ? Edges::kQuick : Edges::kAsTheyAre);
  }
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

void SceneRenderer::compose(const RenderTarget& scene, const RenderTarget& out, Edges edges) {
  out.bind();
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  glDisable(GL_SCISSOR_TEST);
  const GlProgram& program = edges == Edges::kQuick ? quick_compose_ : compose_;
  glUseProgram(program.id());
  set_uniform(program, "scene", 0);
  if (edges != Edges::kQuick) {
    set_uniform(program, "smooth_edges", edges == Edges::kSmooth ? 1.0F : 0.0F);
  }
  set_uniform(program, "scene_px", size_of(scene));
  bind_texture(0, scene.colour());
  glBindVertexArray(screen_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  bind_texture(0, 0);
  glBindVertexArray(0);
}

}  // namespace enamel::view
