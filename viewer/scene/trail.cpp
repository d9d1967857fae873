#include "viewer/scene/trail.hpp"

#include <cmath>
#include <vector>

namespace enamel::view {

Vec3f trail_point(const Pose& T_model_cam, double surface_distance_mm, const ProbeField& field) {
  constexpr double kBeforeSurfaceMm = 4.0;
  const double middle_mm = 0.5 * (field.near_mm + field.far_mm);
  const double depth_mm = std::isfinite(surface_distance_mm) ? surface_distance_mm : middle_mm;
  return (T_model_cam * Vec3d(0, 0, depth_mm - kBeforeSurfaceMm)).cast<float>();
}

void Trail::add(const BurstPreview& burst) {
  if (!burst.placed || burst.burst == last_) {
    return;
  }
  last_ = burst.burst;
  if (burst.track == TrackState::kLost || burst.segment != kModelSegment) {
    if (end_) {
      append(trail_break());
    }
    return;
  }
  const Vec3f point = trail_point(burst.T_model_cam, burst.surface_distance_mm, field_);
  if (!end_ || (point - *end_).norm() >= static_cast<float>(min_step_mm_)) {
    append(point);
  }
  if (points_.size() > max_points_) {
    thin_out();
  }
}

void Trail::append(const Vec3f& point) {
  points_.append(point);
  end_ = point.allFinite() ? std::optional(point) : std::nullopt;
}

void Trail::thin_out() {
  const std::vector<Vec3f> all = points_.view().in_order();
  const std::size_t half = all.size() / 2;
  points_ = {};
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i >= half || i % 2 == 0 || !all[i].allFinite()) {
      points_.append(all[i]);
    }
  }
}

}  // namespace enamel::view
