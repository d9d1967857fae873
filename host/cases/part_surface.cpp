#include "host/cases/part_surface.hpp"

#include <array>
#include <cmath>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace enamel::host {
namespace {

constexpr double kFinePitch_mm = 0.2;    // chosen: between a fused mesh's points and the blocks that are averaged
constexpr double kCoarsePitch_mm = 0.9;  // chosen: 200 elements of a molar's surroundings lay it within 20 um

struct VertexSums {
  std::vector<Vec3d> normals;  ///< times twice the area
  std::vector<double> area_mm2;
};

VertexSums vertex_sums(const Mesh& mesh) {
  VertexSums out{std::vector<Vec3d>(mesh.vertices.size(), Vec3d::Zero()),
                 std::vector<double>(mesh.vertices.size(), 0.0)};
  for (const auto& t : mesh.triangles) {
    const Vec3d a = mesh.vertices[t[0]].cast<double>();
    const Vec3d n = (mesh.vertices[t[1]].cast<double>() - a).cross(mesh.vertices[t[2]].cast<double>() - a);
    for (const std::uint32_t v : t) {
      out.normals[v] += n;
      out.area_mm2[v] += n.norm() / 6;
    }
  }
  return out;
}

std::vector<Vec3f> unit_normals(const VertexSums& sums) {
  std::vector<Vec3f> out;
  for (const Vec3d& n : sums.normals)
    out.push_back(n.norm() > 0 ? Vec3f(n.normalized().cast<float>()) : Vec3f::UnitZ());
  return out;
}

std::vector<bool> border_vertices(const Mesh& mesh) {
  std::unordered_set<std::uint64_t> edges;
  edges.reserve(3 * mesh.triangles.size());
  const auto key = [](std::uint32_t a, std::uint32_t b) { return std::uint64_t{a} << 32U | b; };
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) edges.insert(key(t[k], t[(k + 1) % 3]));
  std::vector<bool> out(mesh.vertices.size(), false);
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      if (!edges.contains(key(t[(k + 1) % 3], t[k]))) out[t[k]] = out[t[(k + 1) % 3]] = true;
  return out;
}

/// The first vertex of every cell stands for all of the cell that look its way.
std::vector<SurfaceElement> elements(const Mesh& mesh, const std::vector<double>& area_mm2, double pitch_mm) {
  std::unordered_map<std::uint64_t, std::size_t> cells;
  std::vector<SurfaceElement> out;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vec3d p = mesh.vertices[v].cast<double>(), n = mesh.normals[v].cast<double>();
    std::uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis) {
      constexpr std::uint64_t kCells = 1U << 20U;  // 21 bits an axis, which leaves one for the side
      const auto cell = static_cast<std::int64_t>(std::floor(p[axis] / pitch_mm));
      key = key << 21U | (static_cast<std::uint64_t>(cell) + kCells) % (2 * kCells);
    }
    auto at = cells.find(key);
    if (at == cells.end() || out[at->second].normal.dot(n) < 0) {
      cells[key] = out.size();
      out.push_back({p, n, 0});
      at = cells.find(key);
    }
    out[at->second].area_mm2 += area_mm2[v];
  }
  return out;
}

}  // namespace

PartSurface::PartSurface(Mesh mesh) : mesh_(std::move(mesh)), tree_(mesh_), on_border_(border_vertices(mesh_)) {
  const VertexSums sums = vertex_sums(mesh_);
  mesh_.normals = unit_normals(sums);
  fine_ = elements(mesh_, sums.area_mm2, kFinePitch_mm);
  coarse_ = elements(mesh_, sums.area_mm2, kCoarsePitch_mm);
}

std::optional<PartSurface::Hit> PartSurface::nearest(const Vec3d& p, double within_mm) const {
  const auto hit = tree_.nearest(p, within_mm);
  if (!hit) return std::nullopt;
  const auto& t = mesh_.triangles[hit->triangle];
  Vec3d normal = Vec3d::Zero();
  for (const std::uint32_t v : t) normal += mesh_.normals[v].cast<double>();
  // Corners, and edges by their two corners; inside of a face nothing is a border.
  constexpr std::array<std::array<std::size_t, 2>, 6> kCorners{{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}}};
  bool border = false;
  if (hit->feature != TriangleFeature::kFace) {
    const auto& corners = kCorners[static_cast<std::size_t>(hit->feature)];
    border = on_border_[t[corners[0]]] && on_border_[t[corners[1]]];
  }
  return Hit{hit->point, normal.norm() > 0 ? Vec3d(normal.normalized()) : Vec3d::UnitZ(), border};
}

}  // namespace enamel::host
