// The true poses of an exchange folder, for tools that judge placements by them.
#pragma once

#include <array>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>
#include <string>

#include "pipeline/types/geometry.hpp"

namespace enamel::test {

/// By burst. Empty: the folder has no truth.
inline std::map<int, Pose> read_true_poses(const std::string& folder) {
  std::map<int, Pose> out;
  std::ifstream in(folder + "/truth/poses.csv");
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::istringstream fields(line);
    std::array<double, 9> v{};
    char comma = 0;
    for (double& x : v) fields >> x >> comma;
    Pose T = Pose::Identity();
    T.linear() = Eigen::Quaterniond(v[8], v[5], v[6], v[7]).normalized().toRotationMatrix();
    T.translation() = Vec3d(v[2], v[3], v[4]);
    out[static_cast<int>(v[0])] = T;
  }
  return out;
}

struct PoseError {
  double mm = 0;  ///< of the point 48 mm before the camera
  double deg = 0;
};

inline PoseError pose_error(const Pose& a, const Pose& b) {
  const Vec3d work(0, 0, 48);
  const Eigen::AngleAxisd turn(a.linear().transpose() * b.linear());
  return {(a * work - b * work).norm(), turn.angle() * 180 / std::numbers::pi};
}

}  // namespace enamel::test
