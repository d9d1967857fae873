#include "pipeline/model/guide/model_sight.hpp"

#include <algorithm>

namespace enamel::pipeline {

ModelSight::ModelSight(const ModelView& view, const ViewCamera& camera, const Pose& T_model_cam)
    : view_(&view),
      camera_(camera),
      T_view_cam_((view.T_model_cam.inverse() * T_model_cam).cast<float>()),
      T_model_cam_(T_model_cam.cast<float>()),
      scale_(1.0F / static_cast<float>(view.stride)) {}

ModelSight::Pixel ModelSight::pixel_of(const Vec3f& p_cam) const noexcept {
  const Vec3f p_view = T_view_cam_ * p_cam;
  if (!(p_view.z() > 1)) return {};
  const Vec2f at = camera_.project(p_view) * scale_;
  if (!(at.minCoeff() > -0.5F) || !(at.maxCoeff() < 1e6F)) return {};
  return {static_cast<int>(std::floor(at.x() + 0.5F)), static_cast<int>(std::floor(at.y() + 0.5F))};
}

float ModelSight::to_plane_mm(const Vec3f& p_cam, Pixel at) const noexcept {
  const bool inside = at.i >= 0 && at.j >= 0 && at.i < view_->points.width() && at.j < view_->points.height();
  if (!inside) return kUnseen;
  const float d = view_->normals(at.i, at.j).dot(T_model_cam_ * p_cam - view_->points(at.i, at.j));
  return std::isfinite(d) ? std::abs(d) : kUnseen;
}

float ModelSight::distance_mm(const Vec3f& p_cam) const noexcept { return to_plane_mm(p_cam, pixel_of(p_cam)); }

float ModelSight::distance_beside_mm(const Vec3f& p_cam) const noexcept {
  const Pixel at = pixel_of(p_cam);
  if (at.i < 0) return kUnseen;
  float least = kUnseen;
  for (const Pixel step : {Pixel{-1, 0}, Pixel{1, 0}, Pixel{0, -1}, Pixel{0, 1}})
    least = std::min(least, to_plane_mm(p_cam, {at.i + step.i, at.j + step.j}));
  return least;
}

}  // namespace enamel::pipeline
