// A model view made ready for registration: which of its pixels may be matched.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/types/model_view.hpp"

namespace enamel::pipeline {

struct ReferenceConfig {
  double pitch_mm = 0.056;    ///< views are thinned to about this between pixels: finer costs time, adds 0.2 µm
  double edge_pitches = 4.5;  ///< a kept pixel with a neighbour (of four) farther away than this many pitches lies on a
                              ///< silhouette: not matched (77 degrees on a smooth surface)
  double normal_radius_mm =
      0.17;  ///< normals are averaged over a square of this half width, about a period of the ripple
             ///< that a moving burst leaves: else it holds on to the next burst's (same place in the image)
  double min_coherence = 0.85;  ///< length of the mean normal: below it the window straddles an edge, not matched
};

/// Memory that drawing a Reference needs; what it holds is of no use to anybody else.
struct ReferenceScratch {
  std::vector<float> line, rows, sums;
  std::vector<std::uint8_t> along, across, across_before;
};

/// A thinned copy of the usable pixels of a view.
class Reference {
 public:
  Reference() = default;
  Reference(const ModelView& view, const ReferenceConfig& config);
  /// Becomes that of another view. Its memory, and the scratch's, is used again.
  void draw(const ModelView& view, const ReferenceConfig& config, ReferenceScratch& scratch);

  [[nodiscard]] bool empty() const noexcept { return usable_px_ == 0; }
  [[nodiscard]] std::size_t usable_px() const noexcept { return usable_px_; }
  [[nodiscard]] const Pose& T_model_cam() const noexcept { return T_model_cam_; }
  [[nodiscard]] int width() const noexcept { return pixels_.width(); }
  [[nodiscard]] int height() const noexcept { return pixels_.height(); }
  [[nodiscard]] float pixels_per_camera_pixel() const noexcept { return scale_; }  ///< 1 / camera pixels a kept pixel

  /// Model frame. x of the point is NaN where nothing may be matched. Padded: one cache line serves two.
  struct alignas(32) Pixel {
    Vec3f point = Vec3f::Zero();
    float unused0 = 0;
    Vec3f normal = Vec3f::Zero();
    float unused1 = 0;
  };
  [[nodiscard]] const Pixel& pixel(std::size_t i) const noexcept { return pixels_[i]; }

 private:
  Pose T_model_cam_ = Pose::Identity();
  Map<Pixel> pixels_;
  float scale_ = 1;
  std::size_t usable_px_ = 0;
};

}  // namespace enamel::pipeline
