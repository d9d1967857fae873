// Jaws in occlusion as a desktop scanner sees them: each alone from above, both together from the cheek's side.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>

#include "pipeline/types/mesh.hpp"
#include "tools/twin/jaw/jaw.hpp"

namespace enamel::host {

/// The part of a mesh that `keep` wants, by its triangles' middles and normals; vertices off by `sigma_mm` along
/// their normals; T applied.
template <class Keep>
Mesh scanned(const Mesh& body, const Keep& keep, double sigma_mm, unsigned seed, const Pose& T) {
  std::mt19937 draw(seed);
  std::normal_distribution<double> noise(0, sigma_mm);
  Mesh out;
  std::vector<std::uint32_t> index(body.vertices.size(), 0xFFFFFFFF);
  for (const auto& t : body.triangles) {
    const Vec3d a = body.vertices[t[0]].cast<double>(), b = body.vertices[t[1]].cast<double>(),
                c = body.vertices[t[2]].cast<double>();
    if (!keep(Vec3d((a + b + c) / 3), Vec3d((b - a).cross(c - a).normalized()))) continue;
    for (const std::uint32_t v : t) {
      if (index[v] != 0xFFFFFFFF) continue;
      index[v] = static_cast<std::uint32_t>(out.vertices.size());
      const Vec3d p = body.vertices[v].cast<double>() + noise(draw) * body.normals[v].cast<double>();
      out.vertices.push_back((T * p).cast<float>());
    }
    out.triangles.push_back({index[t[0]], index[t[1]], index[t[2]]});
  }
  return out;
}

inline Mesh jaw_mesh(twin::JawSide side, std::uint64_t seed, double edge_mm, double from_mm, double to_mm) {
  twin::JawConfig config;
  config.side = side;
  config.both_sides = true;
  config.max_edge_mm = edge_mm;
  config.from_mm = from_mm;
  config.to_mm = to_mm;
  const twin::Jaw jaw = twin::make_jaw(config, seed);
  Mesh out;
  out.vertices = jaw.mesh.vertices;
  out.normals = jaw.mesh.normals;
  out.triangles = jaw.mesh.triangles;
  return out;
}

inline Mesh moved(Mesh mesh, const Pose& T) {
  for (Vec3f& v : mesh.vertices) v = (T * v.cast<double>()).cast<float>();
  for (Vec3f& n : mesh.normals) n = T.linear().cast<float>() * n;
  return mesh;
}

inline Mesh joined(Mesh a, const Mesh& b) {
  const auto first = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  a.normals.insert(a.normals.end(), b.normals.begin(), b.normals.end());
  for (const auto& t : b.triangles) a.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  return a;
}

/// Any turn, some centimetres away.
inline Pose drawn_pose(std::mt19937& draw) {
  std::normal_distribution<double> any;
  Pose T = Pose::Identity();
  T.linear() = Eigen::Quaterniond(any(draw), any(draw), any(draw), any(draw)).normalized().toRotationMatrix();
  T.translation() = 20 * Vec3d(any(draw), any(draw), any(draw));
  return T;
}

/// Upper over lower, biting: in the lower's coordinates. Not a good bite, but one.
inline Pose upper_over_lower(const Mesh& lower, const Mesh& upper) {
  const auto top = [](const Mesh& m) {
    float z = -1e9F;
    for (const Vec3f& v : m.vertices) z = std::max(z, v.z());
    return static_cast<double>(z);
  };
  Pose T = Pose::Identity();
  T.linear() = Eigen::AngleAxisd(M_PI, Vec3d::UnitY()).toRotationMatrix();
  T.translation().z() = top(lower) + top(upper) - 1.5;
  return T;
}

/// What a camera beside the arch sees: surface that looks away from the middle of the arch.
inline bool from_the_cheek(const Vec3d& at, const Vec3d& normal) {
  const Vec3d out = Vec3d(at.x(), at.y() + 18, 0).normalized();
  return normal.dot(out) > 0.35;
}

}  // namespace enamel::host
