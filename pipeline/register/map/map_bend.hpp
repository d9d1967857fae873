// How the map bends what tracking has built: a smooth motion of space by where it moved the keyframes.
#pragma once

#include <vector>

#include "pipeline/types/geometry.hpp"

namespace enamel::pipeline {

struct KeyframeMove {
  Pose tracked, mapped;  ///< T_model_cam of one keyframe
};

struct BendConfig {
  double sigma_mm =
      3;  ///< chosen: a fifth of a picture; keyframes lie 1 mm apart and move by microns against each other
  double reach_mm = 9;  ///< as MapConfig: of a keyframe about the point that it looks at
};

/// Immutable, thread-safe.
class MapBend {
 public:
  MapBend() = default;  ///< nothing moves
  MapBend(const std::vector<KeyframeMove>& moves, double work_distance_mm, const BendConfig& config = {});

  /// What points move by, mm: at one of them, and how it changes from there.
  struct Shift {
    Vec3f at = Vec3f::Zero(), there = Vec3f::Zero();
    Eigen::Matrix3f slope = Eigen::Matrix3f::Zero();
    [[nodiscard]] Vec3f of(const Vec3f& p) const { return there + slope * (p - at); }
  };
  /// Of the model's points that lie within a millimetre of p, to a micron: the mean of the keyframes' motions,
  /// by how near they look; where none looks, the nearest one's.
  [[nodiscard]] Shift around(const Vec3f& p) const;
  /// A probe's pose, moved as the surface that it looks at.
  [[nodiscard]] Pose carry(const Pose& T_model_cam) const;

 private:
  struct Moved {
    Vec3f at;              ///< the point that the keyframe looks at
    Vec3f shift;           ///< of it
    Eigen::Matrix3f turn;  ///< less the identity
  };
  [[nodiscard]] Vec3f shift(const std::vector<Moved>& near, const Vec3f& p) const;

  std::vector<Moved> moved_;
  double work_distance_mm_ = 0;
  BendConfig config_;
};

}  // namespace enamel::pipeline
