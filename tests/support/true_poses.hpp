// The truth beside a rendered set: poses.csv with index, time, place and quaternion of T_model_cam.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "pipeline/types/geometry.hpp"

namespace enamel::test {

/// T_cam_model by index; empty where there is no such file.
inline std::map<int, Pose> true_poses(const std::string& path) {
  std::map<int, Pose> out;
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream row(line);
    int id = 0;
    double t_ns = 0, x = 0, y = 0, z = 0, qx = 0, qy = 0, qz = 0, qw = 1;
    row >> id >> t_ns >> x >> y >> z >> qx >> qy >> qz >> qw;
    out[id] = (Eigen::Translation3d(x, y, z) * Eigen::Quaterniond(qw, qx, qy, qz).normalized()).inverse();
  }
  return out;
}

}  // namespace enamel::test
