#include "calib/target/blobs.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

namespace enamel::calib {
namespace {

constexpr double kMinArea_px = 25;     // half axes below 3 px: no contour to speak of
constexpr double kRoundness = 0.12;    // area against that of the ellipse with the same moments
constexpr double kMaxAspect = 4;       // tilts above 75 degrees are no calibration poses
constexpr double kSizeRange = 3.5;     // areas against the median: perspective within one target
constexpr double kThreshold = 0.3;     // of the local contrast above the local mean
constexpr double kMinContrast_dn = 4;  // below this nothing was lit

/// Pixels clearly brighter than their surroundings. Light varies over the field, so mean and contrast scale together.
cv::Mat bright_pixels(const cv::Mat& image) {
  cv::Mat mean, sorted;
  const int side = std::max(15, image.cols / 5) | 1;
  cv::blur(image, mean, {side, side}, {-1, -1}, cv::BORDER_REPLICATE);
  cv::Mat relative = image / cv::max(mean, 1e-3);
  cv::sort(relative.reshape(1, 1), sorted, cv::SORT_ASCENDING);
  const auto at = [&](double share) { return sorted.at<float>(0, static_cast<int>(share * (sorted.cols - 1))); };
  const double contrast = at(0.99) - at(0.5);
  cv::Mat mask = (relative > 1 + kThreshold * contrast) & (image - mean > kMinContrast_dn);
  return mask;
}

bool touches_border(const cv::Rect& r, const cv::Size& size) {
  return r.x <= 1 || r.y <= 1 || r.x + r.width >= size.width - 1 || r.y + r.height >= size.height - 1;
}

/// Ellipse of an outline's area moments; the outline runs through pixel centres, half a pixel inside the spot.
bool ellipse_of(const std::vector<cv::Point>& outline, Ellipse& e) {
  const cv::Moments m = cv::moments(outline);
  if (!(m.m00 > kMinArea_px)) return false;
  Eigen::Matrix2d second;
  second << m.mu20, m.mu11, m.mu11, m.mu02;
  second /= m.m00;
  if (!(second.determinant() > 0)) return false;
  if (std::abs(m.m00 / (4 * std::numbers::pi * std::sqrt(second.determinant())) - 1) > kRoundness) return false;
  e.centre = {m.m10 / m.m00, m.m01 / m.m00};
  const double radius = std::pow(second.determinant(), 0.25) * 2;
  const double grown = (radius + 0.5) / radius;
  e.shape = second.inverse() / (4 * grown * grown);
  const Eigen::Vector2d axes = e.half_axes();
  return axes[0] < kMaxAspect * axes[1];
}

}  // namespace

std::vector<Blob> find_blobs(const Map<float>& image, bool bright) {
  cv::Mat pixels(image.height(), image.width(), CV_32F);
  std::copy(image.pixels().begin(), image.pixels().end(), pixels.ptr<float>());
  if (!bright) {
    double low = 0, high = 0;
    cv::minMaxLoc(pixels, &low, &high);
    pixels = high - pixels;
  }
  const cv::Mat mask = bright_pixels(pixels);
  std::vector<std::vector<cv::Point>> outlines;
  std::vector<cv::Vec4i> tree;
  cv::findContours(mask, outlines, tree, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
  std::vector<Blob> blobs;
  std::vector<double> areas;
  for (std::size_t i = 0; i < outlines.size(); ++i) {
    Blob blob;
    if (tree[i][3] >= 0 || touches_border(cv::boundingRect(outlines[i]), mask.size())) continue;
    if (!ellipse_of(outlines[i], blob.ellipse)) continue;
    const double area = cv::contourArea(outlines[i]);
    for (int hole = tree[i][2]; hole >= 0; hole = tree[static_cast<std::size_t>(hole)][0])
      blob.has_hole = blob.has_hole || cv::contourArea(outlines[static_cast<std::size_t>(hole)]) > 0.1 * area;
    blobs.push_back(blob);
    areas.push_back(area);
  }
  if (blobs.empty()) return blobs;
  std::vector<double> sorted = areas;
  std::sort(sorted.begin(), sorted.end());
  const double median = sorted[sorted.size() / 2];
  std::vector<Blob> kept;
  for (std::size_t i = 0; i < blobs.size(); ++i)
    if (areas[i] < kSizeRange * median && areas[i] * kSizeRange > median) kept.push_back(blobs[i]);
  return kept;
}

}  // namespace enamel::calib
