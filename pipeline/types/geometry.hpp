// Vectors and rigid motions shared by the algorithms. Poses are double, maps and clouds float: a depth of 48 mm in
// float resolves 4 nm, a chain of poses must not drift.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace enamel {

using Vec2f = Eigen::Vector2f;
using Vec3f = Eigen::Vector3f;
using Vec3d = Eigen::Vector3d;

/// T_dst_src maps src coordinates to dst coordinates (mm). Chains read by cancelling neighbours.
using Pose = Eigen::Isometry3d;

}  // namespace enamel
