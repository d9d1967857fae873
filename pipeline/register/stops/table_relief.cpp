#include "pipeline/register/stops/table_relief.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace enamel::pipeline {
namespace {

constexpr float kUnseen = std::numeric_limits<float>::lowest();

/// Of the first line, nearest to the second. Lines that run alike: its stated point.
Vec3d nearest_point(const calib::AxisLine& line, const calib::AxisLine& other) {
  const Vec3d d(line.direction.data()), p(line.point_mm.data()), e(other.direction.data()), q(other.point_mm.data());
  const Vec3d across = d.cross(e);
  const double sin2 = across.squaredNorm();
  return sin2 > 1e-6 ? Vec3d(p + d * (q - p).cross(e).dot(across) / sin2) : p;
}

}  // namespace

TableRelief::TableRelief(const calib::Mount& mount, const ReliefConfig& config, std::optional<double> above_mm)
    : config_(config),
      above_mm_(above_mm),
      point_(nearest_point(mount.rotation, mount.swing)),
      up_(mount.rotation.direction.data()),
      side_(2 * static_cast<int>(std::ceil(config.reach_mm / config.cell_mm))),
      top_mm_(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_), kUnseen) {
  if (up_.z() > 0) up_ = -up_;  // the camera looks along +z, down on the table
  e1_ = up_.unitOrthogonal();
  e2_ = up_.cross(e1_);
}

double TableRelief::height_mm(const Vec3d& p_model) const { return up_.dot(p_model - point_); }

std::optional<std::size_t> TableRelief::cell_of(const Vec3d& p_model) const {
  const Vec3d q = p_model - point_;
  const int u = static_cast<int>(std::floor(e1_.dot(q) / config_.cell_mm)) + side_ / 2;
  const int v = static_cast<int>(std::floor(e2_.dot(q) / config_.cell_mm)) + side_ / 2;
  if (u < 0 || v < 0 || u >= side_ || v >= side_) return std::nullopt;
  return static_cast<std::size_t>(v) * static_cast<std::size_t>(side_) + static_cast<std::size_t>(u);
}

void TableRelief::add(const SurfacePatch& patch, const Pose& T_model_cam) {
  for (const Vec3f& p : patch.points.pixels()) {
    if (std::isnan(p.x())) continue;
    const Vec3d p_model = T_model_cam * p.cast<double>();
    const auto cell = cell_of(p_model);
    if (!cell) continue;
    float& top = top_mm_[*cell];
    if (top == kUnseen) ++cells_;
    top = std::max(top, static_cast<float>(height_mm(p_model)));
  }
}

std::size_t TableRelief::take_out(const Pose& T_model_cam, SurfacePatch& patch) const {
  if (empty()) return 0;
  std::size_t out = 0;
  const Vec3f nothing = Vec3f::Constant(std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < patch.points.size(); ++i) {
    if (std::isnan(patch.depth_mm[i])) continue;
    const Vec3d p_model = T_model_cam * patch.points[i].cast<double>();
    const double height = height_mm(p_model);
    const auto cell = cell_of(p_model);
    const bool is_low = above_mm_ && height < *above_mm_;
    const bool is_table =
        cell && top_mm_[*cell] != kUnseen && height < static_cast<double>(top_mm_[*cell]) + config_.margin_mm;
    if (!is_low && !is_table) continue;
    patch.depth_mm[i] = patch.sigma_mm[i] = nothing.x();
    patch.points[i] = patch.normals[i] = nothing;
    ++out;
  }
  patch.valid_px -= out;
  return out;
}

}  // namespace enamel::pipeline
