#include "host/mesh_files/polygon.hpp"

#include <algorithm>
#include <numeric>

namespace enamel::host {
namespace {

using Vec2d = Eigen::Vector2d;

/// Twice the area of a triangle, positive when it runs like its polygon.
double turn(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

/// The corners in the polygon's plane; empty where it has none.
std::vector<Vec2d> flattened(const std::vector<std::uint32_t>& corners, const std::vector<Vec3d>& positions) {
  const Vec3d first = positions[corners[0]];
  Vec3d normal = Vec3d::Zero();
  for (std::size_t k = 2; k < corners.size(); ++k) {
    normal += (positions[corners[k - 1]] - first).cross(positions[corners[k]] - first);
  }
  std::vector<Vec2d> out;
  if (!normal.allFinite() || normal.isZero(0)) {
    return out;
  }
  normal.normalize();
  const Vec3d u = normal.unitOrthogonal(), v = normal.cross(u);
  for (const std::uint32_t corner : corners) {
    const Vec3d p = positions[corner] - first;
    out.emplace_back(p.dot(u), p.dot(v));
  }
  return out;
}

/// Of corners at the same place, where a bridge leads to a hole, none is in the other's way.
bool in_the_way(const Vec2d& p, const Vec2d& a, const Vec2d& b, const Vec2d& c) {
  return p != a && p != b && p != c && turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
}

}  // namespace

void unfold_fan(std::span<std::array<std::uint32_t, 3>> fan, const std::vector<Vec3d>& positions,
                std::uint64_t& budget) {
  std::vector<std::uint32_t> corners{fan[0][0], fan[0][1]};
  for (const auto& t : fan) {
    corners.push_back(t[2]);
  }
  const std::vector<Vec2d> flat = flattened(corners, positions);
  bool folded = false;
  for (std::size_t k = 2; k < flat.size(); ++k) {
    folded = folded || turn(flat[0], flat[k - 1], flat[k]) < 0;
  }
  if (!folded) {
    return;
  }
  std::vector<std::size_t> ring(corners.size());
  std::iota(ring.begin(), ring.end(), std::size_t{0});
  std::vector<std::array<std::uint32_t, 3>> ears;
  for (std::size_t at = 0, tried = 0; ring.size() > 2; at = (at + 1) % ring.size()) {
    if (tried++ > ring.size() || budget < ring.size()) {
      return;
    }
    budget -= ring.size();
    const std::size_t a = ring[(at + ring.size() - 1) % ring.size()], b = ring[at], c = ring[(at + 1) % ring.size()];
    const auto blocks = [&](std::size_t k) { return in_the_way(flat[k], flat[a], flat[b], flat[c]); };
    if (turn(flat[a], flat[b], flat[c]) > 0 && std::none_of(ring.begin(), ring.end(), blocks)) {
      ears.push_back({corners[a], corners[b], corners[c]});
      ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(at));
      tried = 0;
    }
  }
  std::copy(ears.begin(), ears.end(), fan.begin());
}

}  // namespace enamel::host
