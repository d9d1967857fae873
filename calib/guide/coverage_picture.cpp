#include "calib/guide/coverage_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "protocol/base/file.hpp"

namespace enamel::calib {
namespace {

constexpr int kFieldWidth = 640, kPanel = 320, kHeader = 40, kFooter = 60;
const cv::Scalar kInk(40, 40, 40), kFaint(225, 225, 225), kDone(120, 170, 60), kLacking(60, 90, 220);

void text(cv::Mat& image, const std::string& words, cv::Point at, double size = 0.5, const cv::Scalar& colour = kInk) {
  cv::putText(image, words, at, cv::FONT_HERSHEY_SIMPLEX, size, colour, 1, cv::LINE_AA);
}

/// One colour a pose, so that a pose's dots, depth and lean belong together.
cv::Scalar pose_colour(std::size_t pose) {
  const double turn = 2 * std::numbers::pi * std::fmod(0.618 * static_cast<double>(pose), 1.0);
  return {120 + 90 * std::cos(turn), 110 + 80 * std::cos(turn + 2.1), 120 + 90 * std::cos(turn + 4.2)};
}

void draw_field(cv::Mat image, const std::vector<SeenPose>& poses, const Coverage& c, const LensValues& camera) {
  const double sx = static_cast<double>(image.cols) / camera.width,
               sy = static_cast<double>(image.rows) / camera.height;
  for (int row = 0; row < Coverage::kRows; ++row) {
    for (int column = 0; column < Coverage::kColumns; ++column) {
      const cv::Rect cell(column * image.cols / Coverage::kColumns, row * image.rows / Coverage::kRows,
                          image.cols / Coverage::kColumns, image.rows / Coverage::kRows);
      const bool seen = c.dots_in_cell[static_cast<std::size_t>(row * Coverage::kColumns + column)] > 0;
      if (!seen) cv::rectangle(image, cell, cv::Scalar(215, 220, 250), cv::FILLED);
      cv::rectangle(image, cell, kFaint);
    }
  }
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (const auto& p : poses[i].dots_px) {
      cv::circle(image, cv::Point2d(p.x() * sx, p.y() * sy), 3, pose_colour(i), cv::FILLED, cv::LINE_AA);
    }
  }
}

void draw_depth(cv::Mat image, const std::vector<SeenPose>& poses, const Coverage& c, const DepthRange& range) {
  const auto y_of = [&](double mm) {
    return static_cast<int>((mm - range.near_mm) / (range.far_mm - range.near_mm) * (image.rows - 40)) + 20;
  };
  cv::rectangle(image, {50, y_of(range.near_mm)}, {image.cols - 12, y_of(range.far_mm)}, kFaint);
  text(image, fmt::format("{:.0f} mm", range.near_mm), {2, y_of(range.near_mm) + 5}, 0.4);
  text(image, fmt::format("{:.0f} mm", range.far_mm), {2, y_of(range.far_mm) + 5}, 0.4);
  const std::array<const char*, 3> names{"near", "middle", "far"};
  for (std::size_t i = 0; i < 3; ++i) {
    const double mid = range.near_mm + (range.far_mm - range.near_mm) * (2 * static_cast<double>(i) + 1) / 6;
    text(image, fmt::format("{}: {}", names[i], c.by_depth[i]), {image.cols - 90, y_of(mid)}, 0.45,
         c.by_depth[i] > 0 ? kInk : kLacking);
  }
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const int x =
        58 + static_cast<int>(i) * (image.cols - 160) / static_cast<int>(std::max<std::size_t>(1, poses.size()));
    cv::circle(image, {x, y_of(poses[i].depth_mm)}, 5, pose_colour(i), cv::FILLED, cv::LINE_AA);
  }
}

void draw_lean(cv::Mat image, const std::vector<SeenPose>& poses) {
  const cv::Point middle(image.cols / 2, image.rows / 2);
  const double px_per_deg = 0.5 * (image.rows - 30) / 45.0;
  for (const int deg : {15, 35}) {
    cv::circle(image, middle, static_cast<int>(deg * px_per_deg), kFaint, 1, cv::LINE_AA);
    text(image, fmt::format("{}", deg), middle + cv::Point(static_cast<int>(deg * px_per_deg) + 2, -2), 0.35);
  }
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double a = poses[i].azimuth_deg * std::numbers::pi / 180, r = poses[i].tilt_deg * px_per_deg;
    cv::circle(image, cv::Point2d(middle.x + r * std::cos(a), middle.y + r * std::sin(a)), 5, pose_colour(i),
               cv::FILLED, cv::LINE_AA);
  }
}

}  // namespace

Result<void> write_coverage_picture(const std::vector<SeenPose>& poses, const Coverage& coverage, const Rig& nominal,
                                    bool is_simulated, const std::string& path) {
  const int field_height = kFieldWidth * nominal.camera.height / nominal.camera.width;
  const int height = std::max(field_height, 2 * kPanel / 3 * 2);
  cv::Mat sheet(height + kHeader + kFooter, kFieldWidth + kPanel, CV_8UC3, cv::Scalar(255, 255, 255));
  text(sheet, fmt::format("{} poses, {:.0f} % of the field", coverage.poses, 100 * coverage.field_share), {10, 26},
       0.6);
  text(sheet, "depth", {kFieldWidth + 10, 26}, 0.6);
  draw_field(sheet(cv::Rect(0, kHeader, kFieldWidth, field_height)), poses, coverage, nominal.camera);
  if (nominal.depth_range)
    draw_depth(sheet(cv::Rect(kFieldWidth, kHeader, kPanel, height / 2)), poses, coverage, *nominal.depth_range);
  text(sheet, "lean, degrees", {kFieldWidth + 10, kHeader + height / 2 + 16}, 0.6);
  draw_lean(sheet(cv::Rect(kFieldWidth, kHeader + height / 2, kPanel, height / 2)), poses);
  const std::string next = coverage.is_enough() ? "enough" : "next: " + coverage.missing.front();
  text(sheet, next, {10, height + kHeader + 26}, 0.6, coverage.is_enough() ? kDone : kLacking);
  if (is_simulated) text(sheet, "SIMULATED", {kFieldWidth + kPanel - 130, height + kHeader + 50}, 0.6, kLacking);
  std::vector<unsigned char> bytes;
  try {
    cv::imencode(".png", sheet, bytes);
  } catch (const cv::Exception& e) {
    return fail(ErrorCode::kFileWrite, path + ": " + e.what());
  }
  return write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace enamel::calib
