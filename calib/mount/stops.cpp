#include "calib/mount/stops.hpp"

#include <algorithm>
#include <limits>
#include <opencv2/calib3d.hpp>

#include "calib/model/lens.hpp"
#include "protocol/base/file.hpp"
#include "protocol/types/axes_table.hpp"

namespace enamel::calib {
namespace {

std::string without_zeros(const std::string& name) {
  const std::size_t first = name.find_first_not_of('0');
  return first == std::string::npos ? "0" : name.substr(first);
}

bool is_number(const std::string& name) {
  return !name.empty() && name.find_first_not_of("0123456789") == std::string::npos;
}

bool is_same(const std::string& pose, const std::string& key) {
  return pose == key || (is_number(pose) && is_number(key) && without_zeros(pose) == without_zeros(key));
}

}  // namespace

Result<std::vector<AxisAngles>> read_pose_axes(const std::string& folder, const std::vector<std::string>& poses) {
  const std::string path = folder + "/axes.csv";
  const auto text = read_file(path);
  if (!text && text.error().code == ErrorCode::kFileNotFound)
    return fail(ErrorCode::kAxesMissing, path + " is missing");
  if (!text) return tl::unexpected<Error>(text.error());
  ENAMEL_TRY_ASSIGN(const auto rows, proto::parse_axes_table(*text, path, proto::AxesKey::kPose));
  std::vector<AxisAngles> out(poses.size());
  std::vector<bool> is_known(poses.size(), false);
  for (const proto::AxesRow& row : rows) {
    const auto at = std::find_if(poses.begin(), poses.end(), [&](const auto& pose) { return is_same(pose, row.key); });
    const std::string place = path + ":" + std::to_string(row.line) + ": pose '" + row.key + "' ";
    if (at == poses.end())
      return fail(ErrorCode::kCalibrationFolder,
                  place + "is no folder under poses/; remove the row or add the pictures");
    const auto i = static_cast<std::size_t>(at - poses.begin());
    if (is_known[i]) return fail(ErrorCode::kCalibrationFolder, place + "has a row already; keep the one that holds");
    is_known[i] = true;
    out[i] = {row.angles_deg[0] * kRadPerDegree, row.angles_deg[1] * kRadPerDegree, row.angles_deg[2] * kRadPerDegree,
              row.angles_deg[3] * kRadPerDegree};
  }
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!is_known[i]) {
      return fail(ErrorCode::kAxesMissing,
                  path + ": no row for pose '" + poses[i] + "'; add its angles or remove its pictures");
    }
  }
  return out;
}

Result<Pose> board_pose(const PoseView& view, const TargetDesign& target, const LensValues& camera) {
  std::vector<cv::Point3d> places;
  std::vector<cv::Point2d> rays;
  for (const DotView& dot : view.dots) {
    const Vec3d p = target.place(dot.dot);
    const PlanePoint ray = undistort(camera, {dot.camera_px.x(), dot.camera_px.y()});
    places.emplace_back(p.x(), p.y(), p.z());
    rays.emplace_back(ray.x, ray.y);
  }
  const auto refuse = [&] {
    return fail(ErrorCode::kCalibrationPoses, "pose " + view.name + ": its dots determine no pose of the board");
  };
  if (places.size() < 4) return refuse();
  cv::Vec3d w, t;
  try {
    const cv::Matx33d unit = cv::Matx33d::eye();
    if (!cv::solvePnP(places, rays, unit, cv::noArray(), w, t, false, cv::SOLVEPNP_IPPE)) return refuse();
    if (!cv::solvePnP(places, rays, unit, cv::noArray(), w, t, true, cv::SOLVEPNP_ITERATIVE)) return refuse();
  } catch (const cv::Exception&) {
    return refuse();
  }
  Pose pose = Pose::Identity();
  const Vec3d turn(w[0], w[1], w[2]);
  if (turn.norm() > 0) pose.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  pose.translation() = Vec3d(t[0], t[1], t[2]);
  if (!pose.matrix().allFinite() || !(t[2] > 0)) return refuse();
  return pose;
}

}  // namespace enamel::calib
