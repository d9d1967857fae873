#include "pipeline/algo/guide/model_sight.hpp"

namespace enamel::algo {

ModelSight::ModelSight(const ModelView& view, const ViewCamera& camera, const Pose& T_model_cam)
    : view_(&view),
      camera_(camera),
      T_view_cam_((view.T_model_cam.inverse() * T_model_cam).cast<float>()),
      T_model_cam_(T_model_cam.cast<float>()),
      scale_(1.0F / static_cast<float>(view.stride)) {}

float ModelSight::distance_mm(const Vec3f& p_cam) const noexcept {
  constexpr float kUnseen = std::numeric_limits<float>::infinity();
  const Vec3f p_view = T_view_cam_ * p_cam;
  if (!(p_view.z() > 1)) return kUnseen;
  const Vec2f at = camera_.project(p_view) * scale_;
  if (!(at.minCoeff() > -0.5F) || !(at.maxCoeff() < 1e6F)) return kUnseen;
  const int i = static_cast<int>(std::floor(at.x() + 0.5F)), j = static_cast<int>(std::floor(at.y() + 0.5F));
  if (i >= view_->points.width() || j >= view_->points.height()) return kUnseen;
  const float d = view_->normals(i, j).dot(T_model_cam_ * p_cam - view_->points(i, j));
  return std::isfinite(d) ? std::abs(d) : kUnseen;
}

}  // namespace enamel::algo
