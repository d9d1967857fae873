// A model view made ready for registration: which of its pixels may be matched.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/algo/icp/view_camera.hpp"
#include "pipeline/types/model_view.hpp"
#include "pipeline/types/patch.hpp"

namespace enamel::algo {

struct ReferenceConfig {
  int step_px = 2;              ///< camera pixels between kept pixels: finer ones cost time and add nothing (0.2 µm)
  double edge_jump_mm = 0.25;   ///< a kept pixel's four neighbours farther than this apart: silhouette, not matched
  int normal_radius = 3;        ///< normals are averaged over (2r+1)^2 kept pixels, about a period of the ripple that a
                                ///< moving burst leaves: else it holds on to the next burst's (same place in the image)
  double min_coherence = 0.85;  ///< length of the mean normal: below it the window straddles an edge, not matched
};

/// View pixel (i, j) looks along the ray of camera pixel (i*scale, j*scale), scale = camera width / view width: a view
/// may be drawn at a half or a quarter of the camera's size. Keeps its own thinned copy; immutable after construction.
class Reference {
 public:
  Reference() = default;
  Reference(const ModelView& view, const ViewCamera& camera, const ReferenceConfig& config);

  [[nodiscard]] bool empty() const noexcept { return usable_px_ == 0; }
  [[nodiscard]] std::size_t usable_px() const noexcept { return usable_px_; }
  [[nodiscard]] const Pose& T_model_cam() const noexcept { return T_model_cam_; }
  [[nodiscard]] int width() const noexcept { return points_.width(); }
  [[nodiscard]] int height() const noexcept { return points_.height(); }
  [[nodiscard]] float pixels_per_camera_pixel() const noexcept { return scale_; }
  /// NaN where it may not be matched.
  [[nodiscard]] const Vec3f& point(std::size_t i) const noexcept { return points_[i]; }
  [[nodiscard]] const Vec3f& normal(std::size_t i) const noexcept { return normals_[i]; }

 private:
  Pose T_model_cam_ = Pose::Identity();
  Map<Vec3f> points_;
  Map<Vec3f> normals_;
  float scale_ = 1;
  std::size_t usable_px_ = 0;
};

/// The patch itself as a view of the model from its own pose: the reference while the model does not yet show this
/// place. step: keep every step-th pixel (1, 2, 4 …).
[[nodiscard]] ModelView view_from_patch(const SurfacePatch& patch, const Pose& T_model_cam, int step = 1);

}  // namespace enamel::algo
