// The path of the probe over the teeth.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>

#include "pipeline/types/geometry.hpp"
#include "pipeline/types/preview.hpp"
#include "viewer/scene/probe_field.hpp"

namespace enamel::view {

/// Point of the path, model frame: on the probe's axis, 4 mm before the surface, so that the path floats over the teeth
/// instead of 48 mm away from them. Without a distance the middle of the field is taken.
[[nodiscard]] Vec3f trail_point(const Pose& T_model_cam, double surface_distance_mm, const ProbeField& field);

/// A break in the path: all NaN.
[[nodiscard]] inline Vec3f trail_break() { return Vec3f::Constant(std::numeric_limits<float>::quiet_NaN()); }

/// Collects the path from the bursts that are shown.
class Trail {
 public:
  explicit Trail(const ProbeField& field, double min_step_mm = 0.2, std::size_t max_points = 20000)
      : field_(field), min_step_mm_(min_step_mm), max_points_(max_points) {}

  /// Adds a placed burst once; a lost one breaks the path. When full the older half loses every second point.
  void add(const BurstPreview& burst);
  /// So far; costs the same however long the path is.
  [[nodiscard]] AppendLog<Vec3f>::View points() const { return points_.view(); }

 private:
  void append(const Vec3f& point);
  void thin_out();

  ProbeField field_;
  double min_step_mm_;
  std::size_t max_points_;
  AppendLog<Vec3f> points_;
  std::optional<Vec3f> end_;  ///< the last of points_; empty where a piece begins
  std::optional<BurstId> last_;
};

}  // namespace enamel::view
