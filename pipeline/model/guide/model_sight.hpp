// How far a point of a placed burst is from the model's surface, as far as the model's view shows it.
#pragma once

#include <cmath>
#include <limits>

#include "pipeline/register/icp/view_camera.hpp"
#include "pipeline/types/model_view.hpp"

namespace enamel::pipeline {

/// Valid while the view lives; immutable, thread-safe.
class ModelSight {
 public:
  ModelSight(const ModelView& view, const ViewCamera& camera, const Pose& T_model_cam);

  /// |distance| of a point in the burst's camera coordinates (mm, z > 0) to the tangent plane of the model's surface on
  /// its ray of the view; +infinity where the view shows none there.
  [[nodiscard]] float distance_mm(const Vec3f& p_cam) const noexcept;

  /// The same to the nearest of the planes of the four pixels around that one: at an edge of the model a burst that
  /// stands microns aside may as well meet those.
  [[nodiscard]] float distance_beside_mm(const Vec3f& p_cam) const noexcept;

 private:
  struct Pixel {
    int i = -1, j = -1;  ///< of the view; negative: the point is behind the camera or outside
  };
  static constexpr float kUnseen = std::numeric_limits<float>::infinity();

  [[nodiscard]] Pixel pixel_of(const Vec3f& p_cam) const noexcept;
  [[nodiscard]] float to_plane_mm(const Vec3f& p_cam, Pixel at) const noexcept;

  const ModelView* view_;
  ViewCamera camera_;
  Eigen::Isometry3f T_view_cam_, T_model_cam_;
  float scale_;
};

}  // namespace enamel::pipeline
