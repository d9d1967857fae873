#include "pipeline/register/stops/view_forecast.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/model/lens.hpp"

namespace enamel::pipeline {
namespace {

constexpr float kNothing = std::numeric_limits<float>::max();
constexpr double kPictureCells = 1.5;  // edge of an image cell: cells half as far again leave no holes in it
constexpr float kStep_mm = 0.5F;       // chosen: less than this in front of a place hides nothing
constexpr double kDepthAbout_mm = 8;   // where the rig states no range

calib::DepthRange range_of(const calib::Rig& rig) {
  const double middle = calib::middle_depth_mm(rig);
  return rig.depth_range.value_or(calib::DepthRange{middle - kDepthAbout_mm, middle + kDepthAbout_mm});
}

Eigen::Isometry3f float_pose(const std::array<std::array<double, 4>, 4>& m) {
  Eigen::Isometry3f T = Eigen::Isometry3f::Identity();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) {
      T.matrix()(r, c) = static_cast<float>(m[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)]);
    }
  }
  return T;
}

double picture_cell_px(const calib::LensValues& lens, const calib::Rig& rig, double cell_mm) {
  return std::max(1.0, kPictureCells * cell_mm * lens.fx / calib::middle_depth_mm(rig));
}

}  // namespace

DepthBuffer::DepthBuffer(const calib::LensValues& lens, double cell_px)
    : lens_(lens), cell_px_(cell_px), columns_(static_cast<int>(std::ceil(lens.width / cell_px))) {
  const int rows = static_cast<int>(std::ceil(lens.height / cell_px));
  constexpr double kRoom = 1.1;  // distortion
  x_limit_ = static_cast<float>(kRoom * std::max(lens.cx, lens.width - lens.cx) / lens.fx);
  y_limit_ = static_cast<float>(kRoom * std::max(lens.cy, lens.height - lens.cy) / lens.fy);
  nearest_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows), kNothing);
}

std::size_t DepthBuffer::at(const Vec3f& p) const {
  if (!(p.z() > 1) || std::abs(p.x()) > x_limit_ * p.z() || std::abs(p.y()) > y_limit_ * p.z()) return kOutside;
  const calib::PlanePoint px =
      calib::project(lens_, {static_cast<double>(p.x() / p.z()), static_cast<double>(p.y() / p.z())});
  const double u = px.x + 0.5, v = px.y + 0.5;
  if (u < 0 || v < 0 || u >= lens_.width || v >= lens_.height) return kOutside;
  return static_cast<std::size_t>(static_cast<int>(v / cell_px_) * columns_ + static_cast<int>(u / cell_px_));
}

void DepthBuffer::clear() { std::fill(nearest_.begin(), nearest_.end(), kNothing); }

bool DepthBuffer::is_empty(std::size_t cell) const { return nearest_[cell] == kNothing; }

ViewForecast::ViewForecast(const calib::Rig& rig, double cell_mm, double least_cosine)
    : least_cosine_(static_cast<float>(least_cosine)),
      near_mm_(static_cast<float>(range_of(rig).near_mm)),
      far_mm_(static_cast<float>(range_of(rig).far_mm)),
      cell_mm_(static_cast<float>(kPictureCells * cell_mm)),
      picture_cell_mm2_(cell_mm_ * cell_mm_),
      T_proj_cam_(float_pose(rig.T_proj_cam)),
      projector_mm_(T_proj_cam_.inverse().translation()),
      camera_(rig.camera, picture_cell_px(rig.camera, rig, cell_mm)),
      projector_(rig.projector, picture_cell_px(rig.projector, rig, cell_mm)) {}

float ViewForecast::cosine_of(const Vec3f& p, const Vec3f& normal) const {
  return std::min(normal.dot(-p.normalized()), normal.dot((projector_mm_ - p).normalized()));
}

/// A slope rises within an image cell by what its incidence makes of the cell's edge.
bool ViewForecast::is_hidden(const Projected& at, float cosine) const {
  const float room = kStep_mm + cell_mm_ * std::sqrt(std::max(0.0F, 1 - cosine * cosine)) / cosine;
  return at.p.z() > camera_.nearest(at.in_camera) + room || at.projector_z > projector_.nearest(at.in_projector) + room;
}

void ViewForecast::look_from(const Pose& T_model_cam, const std::vector<SeenCell>& cells) {
  T_cam_model_ = T_model_cam.inverse().cast<float>();
  camera_.clear();
  projector_.clear();
  projected_.clear();
  seen_.clear();
  for (std::size_t n = 0; n < cells.size(); ++n) {
    const Vec3f p = T_cam_model_ * cells[n].point;
    const Vec3f q = T_proj_cam_ * p;
    const std::size_t in_camera = camera_.at(p), in_projector = projector_.at(q);
    if (in_camera != DepthBuffer::kOutside) camera_.put(in_camera, p.z());
    if (in_projector != DepthBuffer::kOutside) projector_.put(in_projector, q.z());
    if (in_camera == DepthBuffer::kOutside || in_projector == DepthBuffer::kOutside) continue;
    projected_.push_back({static_cast<std::uint32_t>(n), in_camera, in_projector, p, q.z()});
  }
  for (const Projected& at : projected_) {
    if (at.p.z() < near_mm_ || at.p.z() > far_mm_) continue;
    const float cosine = cosine_of(at.p, T_cam_model_.linear() * cells[at.cell].normal);
    if (cosine >= least_cosine_ && !is_hidden(at, cosine)) seen_.push_back({at.cell, cosine});
  }
}

float ViewForecast::look_at(const Vec3f& point, const Vec3f& normal, std::size_t& image_cell) const {
  Projected at;
  at.p = T_cam_model_ * point;
  if (at.p.z() < near_mm_ || at.p.z() > far_mm_) return 0;
  at.in_camera = camera_.at(at.p);
  if (at.in_camera == DepthBuffer::kOutside) return 0;
  const Vec3f q = T_proj_cam_ * at.p;
  at.in_projector = projector_.at(q);
  if (at.in_projector == DepthBuffer::kOutside) return 0;
  at.projector_z = q.z();
  const float cosine = cosine_of(at.p, T_cam_model_.linear() * normal);
  if (cosine < least_cosine_ || is_hidden(at, cosine)) return 0;
  image_cell = at.in_camera;
  return cosine;
}

}  // namespace enamel::pipeline
