// How far a point of a placed burst is from the model's surface, as far as the model's view shows it.
#pragma once

#include <cmath>
#include <limits>

#include "pipeline/algo/icp/view_camera.hpp"
#include "pipeline/types/model_view.hpp"

namespace enamel::algo {

/// Valid while the view lives; immutable, thread-safe.
class ModelSight {
 public:
  ModelSight(const ModelView& view, const ViewCamera& camera, const Pose& T_model_cam);

  /// |distance| of a point in the burst's camera coordinates (mm, z > 0) to the tangent plane of the model's surface on
  /// its ray of the view; +infinity where the view shows none there.
  [[nodiscard]] float distance_mm(const Vec3f& p_cam) const noexcept;

 private:
  const ModelView* view_;
  ViewCamera camera_;
  Eigen::Isometry3f T_view_cam_, T_model_cam_;
  float scale_;
};

}  // namespace enamel::algo
