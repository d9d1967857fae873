#include "host/compare/signed_surface.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace enamel::host {
namespace {

Vec3d unit_or_zero(const Vec3d& v) {
  const double length = v.norm();
  return length > 0 ? Vec3d(v / length) : Vec3d::Zero();
}

}  // namespace

SignedSurface::SignedSurface(Mesh mesh)
    : mesh_(std::move(mesh)),
      tree_(mesh_),
      welded_(mesh_.vertices.size()),
      face_normal_(mesh_.triangles.size()),
      vertex_normal_(mesh_.vertices.size(), Vec3d::Zero()),
      edge_normal_(mesh_.triangles.size()),
      edge_open_(mesh_.triangles.size()),
      vertex_open_(mesh_.vertices.size(), false) {
  weld();
  sum_vertex_normals();
  sum_edge_normals();
}

void SignedSurface::weld() {
  std::vector<std::uint32_t> order(mesh_.vertices.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    order[i] = i;
  }
  const auto key = [&](std::uint32_t i) {
    const Vec3f& v = mesh_.vertices[i];
    return std::tuple(v.x(), v.y(), v.z());
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple_cat(key(a), std::tuple(a)) < std::tuple_cat(key(b), std::tuple(b));
  });
  for (std::size_t k = 0; k < order.size(); ++k) {
    const bool same = k > 0 && key(order[k]) == key(order[k - 1]);
    welded_[order[k]] = same ? welded_[order[k - 1]] : order[k];
  }
}

void SignedSurface::sum_vertex_normals() {
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    const auto& triangle = mesh_.triangles[t];
    const auto p = [&](std::size_t k) -> Vec3d { return mesh_.vertices[triangle[k % 3]].cast<double>(); };
    face_normal_[t] = unit_or_zero((p(1) - p(0)).cross(p(2) - p(0)));
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d a = unit_or_zero(p(k + 1) - p(k));
      const Vec3d b = unit_or_zero(p(k + 2) - p(k));
      vertex_normal_[welded_[triangle[k]]] += face_normal_[t] * std::acos(std::clamp(a.dot(b), -1.0, 1.0));
    }
  }
}

void SignedSurface::sum_edge_normals() {
  struct Side {
    std::uint32_t low, high, triangle, slot;
    bool operator<(const Side& o) const {
      return std::tie(low, high, triangle, slot) < std::tie(o.low, o.high, o.triangle, o.slot);
    }
  };
  std::vector<Side> sides;
  sides.reserve(mesh_.triangles.size() * 3);
  for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t a = welded_[mesh_.triangles[t][k]];
      const std::uint32_t b = welded_[mesh_.triangles[t][(k + 1) % 3]];
      sides.push_back({std::min(a, b), std::max(a, b), t, k});
    }
  }
  std::sort(sides.begin(), sides.end());
  for (std::size_t first = 0; first < sides.size();) {
    std::size_t last = first;
    Vec3d sum = Vec3d::Zero();
    while (last < sides.size() && sides[last].low == sides[first].low && sides[last].high == sides[first].high) {
      sum += face_normal_[sides[last].triangle];
      ++last;
    }
    const bool open = last - first == 1;
    for (; first < last; ++first) {
      const Side& side = sides[first];
      edge_normal_[side.triangle][side.slot] = sum;
      edge_open_[side.triangle][side.slot] = open;
      vertex_open_[side.low] = vertex_open_[side.low] || open;
      vertex_open_[side.high] = vertex_open_[side.high] || open;
    }
  }
}

SignedDistance SignedSurface::distance(const Vec3d& p) const {
  const auto hit = tree_.nearest(p);
  if (!hit) {
    return {std::numeric_limits<double>::quiet_NaN(), p, Vec3d::Zero(), false};
  }
  SignedDistance out{hit->distance_mm, hit->point, face_normal_[hit->triangle], false};
  Vec3d normal = out.normal;
  const auto feature = static_cast<std::size_t>(hit->feature);
  if (feature < 3) {
    const std::uint32_t vertex = welded_[mesh_.triangles[hit->triangle][feature]];
    normal = vertex_normal_[vertex];
    out.on_border = vertex_open_[vertex];
  } else if (feature < 6) {
    normal = edge_normal_[hit->triangle][feature - 3];
    out.on_border = edge_open_[hit->triangle][feature - 3];
  }
  if ((p - hit->point).dot(normal) < 0) {
    out.distance_mm = -out.distance_mm;
  }
  return out;
}

}  // namespace enamel::host
