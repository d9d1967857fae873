#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "host/cases/place_case.hpp"

namespace enamel::host {
namespace {

constexpr ViewShape kPicture{.size_px = 900, .px_per_mm = 24, .distance_mm = 300, .reach_mm = 90};  // a tooth alone
constexpr double kFilled = 0.94;  // chosen: of the picture's width

/// Towards the camera that scanned the bite.
Vec3d bite_looks(const Mesh& bite) {
  Vec3d sum = Vec3d::Zero();
  for (const auto& t : bite.triangles) {
    const Vec3d a = bite.vertices[t[0]].cast<double>();
    sum += (bite.vertices[t[1]].cast<double>() - a).cross(bite.vertices[t[2]].cast<double>() - a);
  }
  return sum.norm() > 0 ? Vec3d(sum.normalized()) : Vec3d::UnitZ();
}

Vec3d middle_of(const Mesh& mesh, const Pose& T) {
  Vec3d low = Vec3d::Constant(1e9), high = -low;
  for (const Vec3f& v : mesh.vertices) {
    low = low.cwiseMin(T * v.cast<double>());
    high = high.cwiseMax(T * v.cast<double>());
  }
  return (low + high) / 2;
}

/// The upper jaw above, seen along the bite's normal.
Pose camera_of(const CaseParts& parts, const PlacedCase& placed) {
  const Vec3d z = -bite_looks(parts.at(kBite)->surface.mesh());
  std::map<std::string, Vec3d> middles;
  Vec3d target = Vec3d::Zero();
  for (const auto& [name, T] : placed.T_frame_part) {
    middles[name] = middle_of(parts.at(name)->surface.mesh(), T);
    target += middles[name] / static_cast<double>(placed.T_frame_part.size());
  }
  Vec3d down = Vec3d::Zero();
  if (middles.contains(kUpper)) down += middles[kBite] - middles[kUpper];
  if (middles.contains(kLower)) down += middles[kLower] - middles[kBite];
  down -= z * z.dot(down);
  Pose T = Pose::Identity();
  T.linear().col(2) = z;
  T.linear().col(1) = down.norm() > 1e-6 ? Vec3d(down.normalized()) : z.unitOrthogonal();
  T.linear().col(0) = T.linear().col(1).cross(z);
  T.translation() = target - kPicture.distance_mm * z;
  return T;
}

/// As large as all of it goes in.
ViewShape shape_for(const CaseParts& parts, const PlacedCase& placed, const Pose& T_frame_view) {
  double half_mm = 0;
  for (const auto& [name, T_frame_part] : placed.T_frame_part) {
    if (name == kBite) continue;
    const Pose T_view_part = T_frame_view.inverse() * T_frame_part;
    for (const Vec3f& v : parts.at(name)->surface.mesh().vertices) {
      const Vec3d p = T_view_part * v.cast<double>();
      half_mm = std::max(half_mm, p.head<2>().cwiseAbs().maxCoeff() * kPicture.distance_mm / p.z());
    }
  }
  ViewShape out = kPicture;
  if (half_mm > 0) out.px_per_mm = std::min(out.px_per_mm, kFilled * 0.5 * out.size_px / half_mm);
  return out;
}

cv::Vec3f colour_of(const std::string& part) {
  if (part == kUpper) return {150, 205, 240};  // blue, green, red
  return part == kLower ? cv::Vec3f{235, 210, 165} : cv::Vec3f{140, 215, 150};
}

}  // namespace

std::vector<std::uint8_t> case_png(const CaseParts& parts, const PlacedCase& placed) {
  std::vector<std::uint8_t> png;
  if (!placed.T_frame_part.contains(kBite) || placed.T_frame_part.size() < 2) return png;
  const Pose T_frame_view = camera_of(parts, placed);
  const ViewShape shape = shape_for(parts, placed, T_frame_view);
  cv::Mat image(kPicture.size_px, kPicture.size_px, CV_8UC3, cv::Scalar(245, 245, 245));
  Map<float> nearest(kPicture.size_px, kPicture.size_px, 1e9F);
  for (const auto& [name, T_frame_part] : placed.T_frame_part) {
    if (name == kBite) continue;
    const SurfacePatch seen = draw_part(parts.at(name)->surface, T_frame_part.inverse() * T_frame_view, shape);
    const cv::Vec3f colour = colour_of(name);
    for (std::size_t i = 0; i < seen.depth_mm.size(); ++i) {
      if (!(seen.depth_mm[i] < nearest[i])) continue;
      nearest[i] = seen.depth_mm[i];
      const float light = 0.25F + 0.75F * std::max(0.0F, -seen.normals[i].dot(seen.points[i].normalized()));
      image.at<cv::Vec3b>(static_cast<int>(i) / kPicture.size_px, static_cast<int>(i) % kPicture.size_px) = cv::Vec3b(
          cv::saturate_cast<std::uint8_t>(light * colour[0]), cv::saturate_cast<std::uint8_t>(light * colour[1]),
          cv::saturate_cast<std::uint8_t>(light * colour[2]));
    }
  }
  cv::imencode(".png", image, png);
  return png;
}

}  // namespace enamel::host
