#include "host/compare/flat_map.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

namespace enamel::host {
namespace {

constexpr double kVoxel_mm = 0.1;  // a vertex is drawn about as large
constexpr int kMostDot_px = 8;

Vec3d middle_of(const Mesh& mesh) {
  Vec3d sum = Vec3d::Zero();
  for (const Vec3f& v : mesh.vertices) sum += v.cast<double>() / static_cast<double>(mesh.vertices.size());
  return sum;
}

/// Rotation that turns the direction of least spread towards the viewer, the normals' side up.
Eigen::Matrix3d flattest_view(const Mesh& mesh, const Vec3d& centre) {
  Eigen::Matrix3d C = Eigen::Matrix3d::Zero();
  for (const Vec3f& v : mesh.vertices) {
    const Vec3d d = v.cast<double>() - centre;
    C += d * d.transpose();
  }
  const Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(C).eigenvectors();
  Vec3d towards = axes.col(0);
  Vec3d outwards = Vec3d::Zero();
  for (const auto& t : mesh.triangles) {
    const Vec3f a = mesh.vertices[t[0]];
    outwards += (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).cast<double>();
  }
  if (towards.dot(outwards) < 0) towards = -towards;
  Eigen::Matrix3d R;
  R.row(0) = axes.col(2).transpose();
  R.row(1) = towards.cross(axes.col(2)).transpose();
  R.row(2) = towards.transpose();
  return R;
}

}  // namespace

FlatMap::FlatMap(const Mesh& mesh, FlatMapSize size) : mesh_(mesh), size_(size), centre_(middle_of(mesh)) {
  R_view_mesh_ = flattest_view(mesh, centre_);
  Vec3d reach = Vec3d::Constant(1e-6);
  for (const Vec3f& v : mesh.vertices) reach = reach.cwiseMax((R_view_mesh_ * (v.cast<double>() - centre_)).cwiseAbs());
  scale_ = std::min((0.5 * size.width - size.margin) / reach.x(), (0.5 * size.height - size.margin) / reach.y());
}

Vec3d FlatMap::project(const Vec3d& p_mm) const {
  const Vec3d p = R_view_mesh_ * (p_mm - centre_);
  return {0.5 * size_.width + scale_ * p.x(), 0.5 * size_.height - scale_ * p.y(), p.z()};
}

std::vector<std::uint8_t> FlatMap::drawn(const VertexColours& colours, std::uint8_t background) const {
  const auto pixels = static_cast<std::size_t>(size_.width) * static_cast<std::size_t>(size_.height);
  std::vector<std::uint8_t> image(3 * pixels, background);
  std::vector<double> nearest(pixels, -std::numeric_limits<double>::infinity());
  const int dot = std::clamp(static_cast<int>(std::ceil(kVoxel_mm * scale_)), 1, kMostDot_px);
  for (std::size_t i = 0; i < mesh_.vertices.size(); ++i) {
    const Vec3d p = project(mesh_.vertices[i].cast<double>());
    const int u = static_cast<int>(p.x()), v = static_cast<int>(p.y());
    for (int y = std::max(0, v); y < std::min(size_.height, v + dot); ++y) {
      for (int x = std::max(0, u); x < std::min(size_.width, u + dot); ++x) {
        const std::size_t at =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(size_.width) + static_cast<std::size_t>(x);
        if (p.z() <= nearest[at]) continue;
        nearest[at] = p.z();
        for (std::size_t c = 0; c < 3; ++c) image[3 * at + c] = colours[i][2 - c];
      }
    }
  }
  return image;
}

}  // namespace enamel::host
