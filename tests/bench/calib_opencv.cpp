#include "tests/bench/calib_opencv.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <opencv2/features2d.hpp>

namespace enamel::bench {
namespace {

struct Points {
  std::vector<std::vector<cv::Point3f>> target;
  std::vector<std::vector<cv::Point2f>> camera, projector;
};

cv::Point2f point(const Eigen::Vector2d& p) { return {static_cast<float>(p.x()), static_cast<float>(p.y())}; }

Points points_of(const std::vector<calib::PoseView>& poses, const calib::TargetDesign& target) {
  Points out;
  for (const calib::PoseView& pose : poses) {
    out.target.emplace_back();
    out.camera.emplace_back();
    out.projector.emplace_back();
    for (const calib::DotView& dot : pose.dots) {
      const Vec3d p = target.place(dot.dot);
      out.target.back().emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()), 0.0F);
      out.camera.back().push_back(point(dot.camera_px));
      out.projector.back().push_back(point(dot.map.projector_px));
    }
  }
  return out;
}

cv::Mat matrix_of(const calib::LensValues& l) {
  return (cv::Mat_<double>(3, 3) << l.fx, 0, l.cx, 0, l.fy, l.cy, 0, 0, 1);
}

calib::LensValues lens_of(const calib::LensValues& size, const cv::Mat& matrix, const cv::Mat& dist) {
  calib::LensValues l{size.width,
                      size.height,
                      matrix.at<double>(0, 0),
                      matrix.at<double>(1, 1),
                      matrix.at<double>(0, 2),
                      matrix.at<double>(1, 2),
                      {}};
  for (int i = 0; i < 5; ++i) l.dist[static_cast<std::size_t>(i)] = dist.at<double>(i);
  return l;
}

}  // namespace

OpenCvRig stereo_calibrate(const std::vector<calib::PoseView>& poses, const calib::TargetDesign& target,
                           const calib::Rig& nominal) {
  const Points p = points_of(poses, target);
  const calib::LensValues &c = nominal.camera, &q = nominal.projector;
  cv::Mat kc = matrix_of(c), kp = matrix_of(q), dc = cv::Mat::zeros(5, 1, CV_64F), dp = dc.clone();
  std::vector<cv::Mat> turns, shifts;
  const int flags = cv::CALIB_USE_INTRINSIC_GUESS | cv::CALIB_FIX_K3;
  const cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 200, 1e-12);
  cv::calibrateCamera(p.target, p.camera, {c.width, c.height}, kc, dc, turns, shifts, flags, until);
  cv::calibrateCamera(p.target, p.projector, {q.width, q.height}, kp, dp, turns, shifts, flags, until);
  cv::Mat turn, shift, essential, fundamental, errors;
  cv::stereoCalibrate(p.target, p.camera, p.projector, kc, dc, kp, dp, {c.width, c.height}, turn, shift, essential,
                      fundamental, errors, flags, until);
  OpenCvRig out;
  out.state.camera = lens_of(c, kc, dc);
  out.state.projector = lens_of(q, kp, dp);
  Eigen::Matrix3d rotation;
  cv::cv2eigen(turn, rotation);
  out.state.T_proj_cam.linear() = rotation;
  out.state.T_proj_cam.translation() = Vec3d(shift.at<double>(0), shift.at<double>(1), shift.at<double>(2));
  for (int j = 0; j < errors.rows; ++j) {
    const double n = static_cast<double>(p.target[static_cast<std::size_t>(j)].size());
    out.rms_camera_px += n * std::pow(errors.at<double>(j, 0), 2);
    out.rms_projector_px += n * std::pow(errors.at<double>(j, 1), 2);
  }
  double all = 0;
  for (const auto& t : p.target) all += static_cast<double>(t.size());
  out.rms_camera_px = std::sqrt(out.rms_camera_px / all);
  out.rms_projector_px = std::sqrt(out.rms_projector_px / all);
  return out;
}

calib::PoseView detector_view(const calib::PoseFrames& frames, const calib::PoseView& ours) {
  cv::Mat white(frames.white.height(), frames.white.width(), CV_8U);
  for (int v = 0; v < white.rows; ++v) {
    for (int u = 0; u < white.cols; ++u) {
      // It seeks dark spots.
      white.at<unsigned char>(v, u) = cv::saturate_cast<unsigned char>(255 - frames.white(u, v));
    }
  }
  std::vector<cv::KeyPoint> spots;
  cv::SimpleBlobDetector::create()->detect(white, spots);
  calib::PoseView out;
  out.name = ours.name;
  for (const calib::DotView& dot : ours.dots) {
    const auto nearest = std::min_element(spots.begin(), spots.end(), [&](const auto& a, const auto& b) {
      return cv::norm(a.pt - point(dot.camera_px)) < cv::norm(b.pt - point(dot.camera_px));
    });
    if (nearest == spots.end() || cv::norm(nearest->pt - point(dot.camera_px)) > 2) continue;
    calib::DotView found = dot;
    found.camera_px = {static_cast<double>(nearest->pt.x), static_cast<double>(nearest->pt.y)};
    const auto map = calib::fit_local_map(found.samples, found.camera_px);
    if (!map) continue;
    found.map = *map;
    out.dots.push_back(std::move(found));
  }
  return out;
}

}  // namespace enamel::bench
