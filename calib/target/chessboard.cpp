#include "calib/target/chessboard.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace enamel::calib {
namespace {

constexpr double kWindowShare = 1.0 / 3;
constexpr int kMinWindow_px = 2, kMaxWindow_px = 6;
constexpr int kMaxRounds = 60;
constexpr double kSettled_px = 1e-4;

double smallest_distance(const std::vector<cv::Point2f>& corners) {
  double least = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) least = std::min(least, cv::norm(corners[i] - corners[j]));
  return least;
}

}  // namespace

Result<std::vector<BoardCorner>> find_chessboard(const Map<float>& image, const TargetDesign& target) {
  cv::Mat grey(image.height(), image.width(), CV_32F);
  std::copy(image.pixels().begin(), image.pixels().end(), grey.ptr<float>());
  double low = 0, high = 0;
  cv::minMaxLoc(grey, &low, &high);
  cv::Mat bytes;
  grey.convertTo(bytes, CV_8U, high > low ? 255 / (high - low) : 1, high > low ? -255 * low / (high - low) : 0);
  std::vector<cv::Point2f> corners;
  const cv::Size size(target.cols, target.rows);
  if (!cv::findChessboardCorners(bytes, size, corners)) {
    return fail(ErrorCode::kTargetNotFound,
                fmt::format("no chessboard of {} x {} inner corners in view", target.cols, target.rows));
  }
  // The detector may start at either end of the same board: the one from which columns run right or down is kept.
  const cv::Point2f along = corners[static_cast<std::size_t>(target.cols - 1)] - corners[0];
  if (along.x + along.y < 0) std::reverse(corners.begin(), corners.end());
  const int window =
      std::clamp(static_cast<int>(kWindowShare * smallest_distance(corners)), kMinWindow_px, kMaxWindow_px);
  cv::cornerSubPix(grey, corners, {window, window}, {-1, -1},
                   {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, kMaxRounds, kSettled_px});
  std::vector<BoardCorner> out;
  for (int i = 0; i < target.size(); ++i) {
    const cv::Point2f& p = corners[static_cast<std::size_t>(i)];
    out.push_back({i, Eigen::Vector2d(static_cast<double>(p.x), static_cast<double>(p.y))});
  }
  return out;
}

}  // namespace enamel::calib
