// What a stop would see of a surface known coarsely: camera and projector look at its cells through two coarse depth
// buffers. mm, model frame of pose_by_axes. Deterministic; one owner.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "calib/model/rig.hpp"
#include "pipeline/register/stops/seen_surface.hpp"
#include "pipeline/types/geometry.hpp"

namespace enamel::pipeline {

/// A lens with an image of square cells, each with the nearest depth in it.
class DepthBuffer {
 public:
  DepthBuffer(const calib::LensValues& lens, double cell_px);

  static constexpr std::size_t kOutside = SIZE_MAX;
  /// Image cell of a point in the lens's frame; kOutside: not in its picture.
  [[nodiscard]] std::size_t at(const Vec3f& p) const;
  void clear();
  void put(std::size_t cell, float z) {
    if (z < nearest_[cell]) nearest_[cell] = z;
  }
  [[nodiscard]] float nearest(std::size_t cell) const { return nearest_[cell]; }
  [[nodiscard]] bool is_empty(std::size_t cell) const;
  [[nodiscard]] std::size_t size() const noexcept { return nearest_.size(); }

 private:
  calib::LensValues lens_;
  double cell_px_;
  int columns_;
  float x_limit_, y_limit_;  ///< of x/z: beyond it nothing is worth projecting
  std::vector<float> nearest_;
};

class ViewForecast {
 public:
  /// least_cosine: of either incidence; what is seen flatter does not count.
  ViewForecast(const calib::Rig& rig, double cell_mm, double least_cosine);

  /// From here on everything is asked of this pose. `cells` must live as long.
  void look_from(const Pose& T_model_cam, const std::vector<SeenCell>& cells);

  /// The worse incidence's cosine of a place in the camera's frame.
  [[nodiscard]] float cosine_of(const Vec3f& p, const Vec3f& normal) const;

  struct View {
    std::uint32_t cell = 0;
    float cosine = 0;  ///< the worse incidence
  };
  /// The cells that are seen, in their order.
  [[nodiscard]] const std::vector<View>& seen() const noexcept { return seen_; }

  /// The worse incidence's cosine at which a guessed place would be seen; 0: not. `image_cell`: where.
  [[nodiscard]] float look_at(const Vec3f& point, const Vec3f& normal, std::size_t& image_cell) const;
  [[nodiscard]] const DepthBuffer& picture() const noexcept { return camera_; }
  /// Of an image cell on a surface at that incidence, about the middle of the depth range.
  [[nodiscard]] float area_mm2(float cosine) const { return picture_cell_mm2_ / cosine; }

 private:
  struct Projected {
    std::uint32_t cell = 0;
    std::size_t in_camera = 0, in_projector = 0;
    Vec3f p = Vec3f::Zero();  ///< camera frame
    float projector_z = 0;
  };
  [[nodiscard]] bool is_hidden(const Projected& at, float cosine) const;

  float least_cosine_, near_mm_, far_mm_, cell_mm_, picture_cell_mm2_;
  Eigen::Isometry3f T_proj_cam_, T_cam_model_ = Eigen::Isometry3f::Identity();
  Vec3f projector_mm_;  ///< camera frame
  DepthBuffer camera_, projector_;
  std::vector<Projected> projected_;
  std::vector<View> seen_;
};

}  // namespace enamel::pipeline
