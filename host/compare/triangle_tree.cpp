#include "host/compare/triangle_tree.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace enamel::host {
namespace {

constexpr std::uint32_t kLeaf = 4;
constexpr std::size_t kMaxDepth = 128;

}  // namespace

Nearest nearest_on_triangle(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const auto found = [&p](const Vec3d& q, TriangleFeature feature) { return Nearest{(p - q).norm(), q, 0, feature}; };
  const Vec3d ab = b - a;
  const Vec3d ac = c - a;
  const Vec3d ap = p - a;
  const double d1 = ab.dot(ap);
  const double d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) {
    return found(a, TriangleFeature::kVertex0);
  }
  const Vec3d bp = p - b;
  const double d3 = ab.dot(bp);
  const double d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) {
    return found(b, TriangleFeature::kVertex1);
  }
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    return found(a + ab * (d1 / (d1 - d3)), TriangleFeature::kEdge01);
  }
  const Vec3d cp = p - c;
  const double d5 = ab.dot(cp);
  const double d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) {
    return found(c, TriangleFeature::kVertex2);
  }
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    return found(a + ac * (d2 / (d2 - d6)), TriangleFeature::kEdge20);
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    return found(b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))), TriangleFeature::kEdge12);
  }
  const double scale = 1.0 / (va + vb + vc);
  return found(a + ab * (vb * scale) + ac * (vc * scale), TriangleFeature::kFace);
}

TriangleTree::TriangleTree(const Mesh& mesh)
    : mesh_(mesh), centroids_(mesh.triangles.size()), order_(mesh.triangles.size()) {
  std::iota(order_.begin(), order_.end(), 0U);
  for (std::uint32_t i = 0; i < order_.size(); ++i) {
    centroids_[i] = (corner(i, 0) + corner(i, 1) + corner(i, 2)) / 3.0;
  }
  if (!order_.empty()) {
    nodes_.reserve(order_.size());
    build(0, static_cast<std::uint32_t>(order_.size()));
  }
}

Vec3d TriangleTree::corner(std::uint32_t triangle, std::size_t k) const {
  return mesh_.vertices[mesh_.triangles[triangle][k]].cast<double>();
}

// Median split along the longest axis of the centroids: balanced, so the depth is the logarithm of the size.
std::uint32_t TriangleTree::build(std::uint32_t first, std::uint32_t count) {
  const auto id = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  Vec3d low = Vec3d::Constant(std::numeric_limits<double>::infinity());
  Vec3d high = -low;
  Vec3d centre_low = low;
  Vec3d centre_high = high;
  for (std::uint32_t i = first; i < first + count; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      low = low.cwiseMin(corner(order_[i], k));
      high = high.cwiseMax(corner(order_[i], k));
    }
    centre_low = centre_low.cwiseMin(centroids_[order_[i]]);
    centre_high = centre_high.cwiseMax(centroids_[order_[i]]);
  }
  nodes_[id].low = low;
  nodes_[id].high = high;
  if (count <= kLeaf) {
    nodes_[id].first = first;
    nodes_[id].count = count;
    return id;
  }
  int axis = 0;
  (centre_high - centre_low).maxCoeff(&axis);
  const auto begin = order_.begin() + first;
  const std::uint32_t half = count / 2;
  std::nth_element(begin, begin + half, begin + count, [&](std::uint32_t a, std::uint32_t b) {
    const double x = centroids_[a][axis];
    const double y = centroids_[b][axis];
    return x < y || (x == y && a < b);
  });
  build(first, half);
  nodes_[id].first = build(first + half, count - half);
  return id;
}

double TriangleTree::distance2(const Node& node, const Vec3d& p) {
  const Vec3d outside = (node.low - p).cwiseMax(p - node.high).cwiseMax(0.0);
  return outside.squaredNorm();
}

std::optional<Nearest> TriangleTree::nearest(const Vec3d& p, double within_mm) const {
  if (nodes_.empty()) {
    return std::nullopt;
  }
  std::optional<Nearest> best;
  double limit2 = within_mm * within_mm;
  std::array<std::pair<std::uint32_t, double>, kMaxDepth> stack;
  std::size_t depth = 0;
  stack[depth++] = {0, distance2(nodes_[0], p)};
  while (depth > 0) {
    const auto [id, node_distance2] = stack[--depth];
    if (node_distance2 >= limit2) {
      continue;
    }
    const Node& node = nodes_[id];
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      Nearest hit = nearest_on_triangle(p, corner(order_[i], 0), corner(order_[i], 1), corner(order_[i], 2));
      if (hit.distance_mm * hit.distance_mm < limit2) {
        hit.triangle = order_[i];
        limit2 = hit.distance_mm * hit.distance_mm;
        best = hit;
      }
    }
    if (node.count == 0) {
      std::pair<std::uint32_t, double> left{id + 1, distance2(nodes_[id + 1], p)};
      std::pair<std::uint32_t, double> right{node.first, distance2(nodes_[node.first], p)};
      if (left.second < right.second) {
        std::swap(left, right);
      }
      stack[depth++] = left;  // the nearer one is taken first
      stack[depth++] = right;
    }
  }
  return best;
}

}  // namespace enamel::host
