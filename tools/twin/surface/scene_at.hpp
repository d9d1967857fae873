// What stands before the probe at one instant: the mouth, which rests, and bodies that move by themselves.
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <span>
#include <vector>

#include "tools/twin/surface/ray_scene.hpp"

namespace enamel::twin {

/// A body at one instant. Its rays are cast in its own frame, so nothing is built anew where it only moves.
struct Guest {
  std::shared_ptr<const RayScene> scene;
  Eigen::Isometry3d T_guest_model = Eigen::Isometry3d::Identity();
};
using Guests = std::vector<Guest>;

/// Same queries as RayScene. Valid while scene and guests live.
class SceneAt {
 public:
  SceneAt(const RayScene& still, std::span<const Guest> guests) : still_(still), guests_(guests) {}

  void intersect(const RayPacket& rays, HitPacket& hits) const;
  void occluded(const RayPacket& rays, std::array<bool, kPacket>& blocked) const;
  [[nodiscard]] bool resolve(const HitPacket& hits, std::size_t i, const Vec3d& origin, const Vec3d& direction,
                             RayScene::Surfel& out) const;

 private:
  const RayScene& still_;
  std::span<const Guest> guests_;
};

}  // namespace enamel::twin
