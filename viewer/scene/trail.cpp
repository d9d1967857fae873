#include "viewer/scene/trail.hpp"

#include <cmath>
#include <utility>

namespace enamel::view {

Vec3f trail_point(const Pose& T_model_cam, double surface_distance_mm, const ProbeField& field) {
  constexpr double kBeforeSurfaceMm = 4.0;
  const double middle_mm = 0.5 * (field.near_mm + field.far_mm);
  const double depth_mm = std::isfinite(surface_distance_mm) ? surface_distance_mm : middle_mm;
  return (T_model_cam * Vec3d(0, 0, depth_mm - kBeforeSurfaceMm)).cast<float>();
}

void Trail::add(const PreviewFrame& frame) {
  if (!frame.placed || (any_ && frame.burst == last_)) {
    return;
  }
  any_ = true;
  last_ = frame.burst;
  if (frame.track == TrackState::kLost) {
    if (!points_.empty() && points_.back().allFinite()) {
      points_.push_back(trail_break());
    }
    return;
  }
  const Vec3f point = trail_point(frame.T_model_cam, frame.surface_distance_mm, field_);
  const bool starts_piece = points_.empty() || !points_.back().allFinite();
  if (starts_piece || (point - points_.back()).norm() >= static_cast<float>(min_step_mm_)) {
    points_.push_back(point);
  }
  if (points_.size() > max_points_) {
    thin_out();
  }
}

void Trail::thin_out() {
  const std::size_t half = points_.size() / 2;
  std::vector<Vec3f> kept;
  kept.reserve(points_.size());
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (i >= half || i % 2 == 0 || !points_[i].allFinite()) {
      kept.push_back(points_[i]);
    }
  }
  points_ = std::move(kept);
}

}  // namespace enamel::view
