#include "tools/twin/render/seen.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace enamel::twin {
namespace {

constexpr double kClusterMm = 2.0;
constexpr double kMinCosine = 0.3420201433256687;  // 70 degrees
/// Depth agreement between a vertex and the pixel centres about it: at 70 degrees the surface falls 2.75 mm a mm, and
/// the farthest of the four centres is 1.4 px = 0.04 mm away.
constexpr double kDepthToleranceMm = 0.12;

}  // namespace

SeenCounter::SeenCounter(const Instrument& instrument, const TriSurface& truth)
    : instrument_(instrument),
      truth_(truth),
      near_mm_(instrument.rig.depth_range ? instrument.rig.depth_range->near_mm : 40.0),
      far_mm_(instrument.rig.depth_range ? instrument.rig.depth_range->far_mm : 56.0),
      counts_(truth.vertices.size(), 0) {
  std::map<std::array<int, 3>, Cluster> cells;
  for (std::uint32_t i = 0; i < truth.vertices.size(); ++i) {
    std::array<int, 3> key{};
    for (std::size_t k = 0; k < 3; ++k) {
      key[k] = static_cast<int>(std::floor(static_cast<double>(truth.vertices[i][static_cast<int>(k)]) / kClusterMm));
    }
    cells[key].vertices.push_back(i);
  }
  for (auto& [key, cluster] : cells) {
    cluster.centre = kClusterMm * Vec3d(key[0] + 0.5, key[1] + 0.5, key[2] + 0.5);
    cluster.radius = 0.5 * std::sqrt(3.0) * kClusterMm;
    clusters_.push_back(std::move(cluster));
  }
}

bool SeenCounter::sees(const Pose& T_cam_model, const Vec3d& projector_model, const TruthMaps& maps,
                       std::uint32_t vertex) const {
  const Vec3d p = truth_.vertices[vertex].cast<double>();
  const Vec3d c = T_cam_model * p;
  if (c.z() < near_mm_ || c.z() > far_mm_) return false;
  double u = 0, v = 0;
  if (!instrument_.camera.project(c.x(), c.y(), c.z(), u, v)) return false;
  const int width = instrument_.rig.camera.width, height = instrument_.rig.camera.height;
  const int x0 = static_cast<int>(std::floor(u)), y0 = static_cast<int>(std::floor(v));
  if (x0 < 0 || y0 < 0 || x0 + 1 >= width || y0 + 1 >= height) return false;
  const Vec3d normal = truth_.normals[vertex].cast<double>();
  const Vec3d n = T_cam_model.linear() * normal;
  if (-n.dot(c) < kMinCosine * c.norm()) return false;
  const Vec3d to_light = projector_model - p;
  if (normal.dot(to_light) < kMinCosine * to_light.norm()) return false;
  const Vec3d q = instrument_.T_proj_cam * c;
  double pu = 0, pv = 0;
  if (!instrument_.projector.project(q.x(), q.y(), q.z(), pu, pv) || !instrument_.projector.in_frame(pu, pv)) {
    return false;
  }
  // Lit and visible: a pixel centre beside it shows this depth and light.
  for (int k = 0; k < 4; ++k) {
    const std::size_t at =
        static_cast<std::size_t>(y0 + k / 2) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x0 + k % 2);
    if (maps.lit[at] != 0 && std::abs(static_cast<double>(maps.depth[at]) - c.z()) < kDepthToleranceMm) return true;
  }
  return false;
}

void SeenCounter::add(const Pose& T_model_cam, const TruthMaps& maps) {
  const Pose T_cam_model = T_model_cam.inverse();
  const Vec3d projector_model = T_model_cam * instrument_.T_proj_cam.inverse().translation();
  const auto& cam = instrument_.rig.camera;
  const double half_field = std::hypot(cam.width / cam.fx, cam.height / cam.fy) * 0.6;
  tbb::parallel_for(std::size_t{0}, clusters_.size(), [&](std::size_t i) {
    const Cluster& cluster = clusters_[i];
    const Vec3d c = T_cam_model * cluster.centre;
    if (c.z() + cluster.radius < near_mm_ || c.z() - cluster.radius > far_mm_) return;
    if (c.head<2>().norm() > half_field * c.z() + 2 * cluster.radius) return;
    for (const std::uint32_t v : cluster.vertices) {
      if (counts_[v] < 255 && sees(T_cam_model, projector_model, maps, v)) ++counts_[v];
    }
  });
}

}  // namespace enamel::twin
