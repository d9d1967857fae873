// What the images of a pose say about the target's dots, and the state that explains it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/fringe/disc_coordinates.hpp"
#include "calib/model/rig.hpp"
#include "calib/target/target.hpp"

namespace enamel::calib {

struct DotView {
  int dot = 0;                                                   ///< TargetDesign::index
  Ellipse ellipse;                                               ///< fitted to the disc's image
  Eigen::Matrix2d covariance_px2 = Eigen::Matrix2d::Identity();  ///< of the ellipse's centre
  std::vector<ProjectorSample> samples;
  // Made from the above, given a state:
  Eigen::Vector2d camera_px{0, 0};  ///< image of the disc's centre: the ellipse's centre less its bias
  LocalMap map;                     ///< projector coordinates at camera_px
  bool is_outlier = false;
};

/// The board's ground between the dots: means over 5 x 5 camera pixels.
struct GroundSample {
  Eigen::Vector2d camera_px{0, 0};  ///< the block's middle
  double projector_u_px = 0;
  double variance_px2 = 0;                           ///< of the mean, from the scatter inside the pose's blocks
  Eigen::Vector4d ripple = Eigen::Vector4d::Zero();  ///< means of the ripple's four harmonics; zero once it is off
  Eigen::Vector2d cell{0, 0};                        ///< column and row of the grid, fractional
};

struct PoseView {
  std::string name;
  std::vector<DotView> dots;
  std::vector<GroundSample> ground;  ///< empty where none was measured
  double blur_px = 0;                ///< median sigma of the edges
};

/// Everything the solver seeks. T_cam_target maps target (model) coordinates to camera coordinates.
struct RigState {
  LensValues camera, projector;
  Pose T_proj_cam = Pose::Identity();
  std::vector<Pose> T_cam_target;             ///< one a pose
  std::vector<Vec3d> dot_offsets_mm;          ///< real place less design place, one a dot; zero for a perfect target
  std::optional<CorrectionField> correction;  ///< what the lens model leaves
};

}  // namespace enamel::calib
