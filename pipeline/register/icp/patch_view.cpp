#include "pipeline/register/icp/patch_view.hpp"

#include <cmath>
#include <limits>

#include "calib/model/lens.hpp"

namespace enamel::pipeline {

PatchViewer::PatchViewer(const calib::LensValues& lens, int width, int height, int stride)
    : width_(width),
      height_(height),
      stride_(stride),
      source_((width + stride - 1) / stride, (height + stride - 1) / stride, -1) {
  for (int j = 0; j < source_.height(); ++j) {
    for (int i = 0; i < source_.width(); ++i) {
      // The patch lies in the lens's picture, the view in the ideal one.
      const auto px = calib::project(lens, {(i * stride - lens.cx) / lens.fx, (j * stride - lens.cy) / lens.fy});
      const double u = std::floor(px.x + 0.5), v = std::floor(px.y + 0.5);
      if (!(u >= 0 && v >= 0 && u < width && v < height)) continue;
      source_(i, j) = static_cast<std::int32_t>(v) * width + static_cast<std::int32_t>(u);
    }
  }
}

ModelView PatchViewer::operator()(const SurfacePatch& patch, const Pose& T_model_cam) const {
  ModelView view;
  view.T_model_cam = T_model_cam;
  view.stride = stride_;
  if (patch.points.width() != width_ || patch.points.height() != height_) return view;
  view.points = Map<Vec3f>(source_.width(), source_.height(), Vec3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  view.normals = view.points;
  const Eigen::Matrix3f R = T_model_cam.linear().cast<float>();
  const Vec3f t = T_model_cam.translation().cast<float>();
  for (std::size_t i = 0; i < source_.size(); ++i) {
    if (source_[i] < 0) continue;
    const auto pixel = static_cast<std::size_t>(source_[i]);
    const Vec3f& p = patch.points[pixel];
    const Vec3f& n = patch.normals[pixel];
    if (!std::isfinite(p.x()) || !std::isfinite(n.x())) continue;
    view.points[i] = R * p + t;
    view.normals[i] = R * n;
    view.empty = false;
  }
  return view;
}

ModelView view_from_patch(const SurfacePatch& patch, const Pose& T_model_cam, const calib::LensValues& lens,
                          int stride) {
  return PatchViewer(lens, patch.points.width(), patch.points.height(), stride)(patch, T_model_cam);
}

ModelView carried_into(const Pose& T_other_model, ModelView view) {
  view.T_model_cam = T_other_model * view.T_model_cam;
  const Eigen::Matrix3f R = T_other_model.linear().cast<float>();
  const Vec3f t = T_other_model.translation().cast<float>();
  for (Vec3f& p : view.points.pixels()) p = R * p + t;
  for (Vec3f& n : view.normals.pixels()) n = R * n;
  return view;
}

}  // namespace enamel::pipeline
