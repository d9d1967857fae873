#include "host/defects/defect_picture.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "host/compare/flat_map.hpp"

namespace enamel::host {
namespace {

constexpr FlatMapSize kMap;
constexpr int kLine_px = 26, kMargin_px = 16;
constexpr std::size_t kMostLines = 20;  // chosen: what is read; the rest is in report.json
constexpr std::size_t kMostLetters = 128;
constexpr double kLeastRing_px = 14, kHidden_mm = 1.5;
constexpr std::uint8_t kGrey = 225;

/// Shaded as if lit from the viewer, so that form shows.
VertexColours shades(const Mesh& mesh, const FlatMap& map) {
  VertexColours out(mesh.vertices.size(), {200, 200, 200});
  for (std::size_t i = 0; i < mesh.normals.size() && i < out.size(); ++i) {
    const double facing = std::clamp(map.facing(mesh.normals[i].cast<double>()), 0.0, 1.0);
    out[i].fill(static_cast<std::uint8_t>(std::lround(70 + 140 * facing)));
  }
  return out;
}

/// How near to the viewer the surface comes over a place, mm.
double nearest_over(const Mesh& mesh, const FlatMap& map, const Vec3d& place) {
  double z = place.z();
  for (const Vec3f& v : mesh.vertices) {
    const Vec3d p = map.project(v.cast<double>());
    if ((p - place).head<2>().squaredNorm() < 4) z = std::max(z, p.z());
  }
  return z;
}

void ring(cv::Mat& image, cv::Point at, int radius, bool hidden, const std::string& number) {
  const cv::Scalar ink(30, 30, 210), paper(255, 255, 255);
  constexpr int kDash_deg = 60;
  for (const auto& [colour, width] : {std::pair{paper, 5}, std::pair{ink, 2}}) {
    for (int a = 0; a < 360; a += kDash_deg)
      cv::ellipse(image, at, {radius, radius}, 0, a, a + (hidden ? kDash_deg / 3 : kDash_deg), colour, width,
                  cv::LINE_AA);
    cv::putText(image, number, at + cv::Point(radius + 4, -radius / 2), cv::FONT_HERSHEY_SIMPLEX, 0.7, colour, width,
                cv::LINE_AA);
  }
}

void write_line(cv::Mat& image, std::size_t line, std::string words) {
  if (words.size() > kMostLetters) words = words.substr(0, kMostLetters - 3) + "...";
  const cv::Point at(kMargin_px, kMap.height + static_cast<int>(line + 1) * kLine_px);
  cv::putText(image, words, at, cv::FONT_HERSHEY_SIMPLEX, 0.55, cv::Scalar(30, 30, 30), 1, cv::LINE_AA);
}

}  // namespace

std::vector<std::uint8_t> defects_png(const Mesh& mesh, const std::vector<Defect>& defects) {
  std::vector<std::uint8_t> png;
  if (mesh.vertices.empty()) return png;
  const std::size_t lines = std::min(defects.size(), kMostLines);
  const int foot = static_cast<int>(std::max<std::size_t>(1, lines + (lines < defects.size() ? 1 : 0))) * kLine_px;
  cv::Mat image(kMap.height + foot + kMargin_px, kMap.width, CV_8UC3, cv::Scalar(kGrey, kGrey, kGrey));
  const FlatMap map(mesh, kMap);
  std::vector<std::uint8_t> drawn = map.drawn(shades(mesh, map), kGrey);
  cv::Mat(kMap.height, kMap.width, CV_8UC3, drawn.data()).copyTo(image.rowRange(0, kMap.height));
  for (std::size_t i = 0; i < defects.size(); ++i) {
    const Vec3d place = map.project(defects[i].p_model_mm);
    const double radius = std::sqrt(defects[i].size_mm2 / std::numbers::pi) * map.px_per_mm();
    const bool hidden = nearest_over(mesh, map, place) > place.z() + kHidden_mm;
    const std::string number = std::to_string(i + 1);
    ring(image, {static_cast<int>(place.x()), static_cast<int>(place.y())},
         static_cast<int>(std::max(kLeastRing_px, radius)), hidden, number);
    if (i < lines) write_line(image, i, number + "  " + defect_line(defects[i]));
  }
  if (defects.empty()) write_line(image, 0, "nothing is wrong that can be told");
  if (lines < defects.size()) write_line(image, lines, std::to_string(defects.size() - lines) + " more in report.json");
  cv::imencode(".png", image, png);
  return png;
}

}  // namespace enamel::host
