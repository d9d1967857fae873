#include "tools/twin/surface/tri_surface.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>

namespace enamel::twin {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

struct Edge {
  std::uint32_t a, b;
  friend bool operator==(const Edge&, const Edge&) = default;
  friend bool operator<(const Edge& x, const Edge& y) { return std::tie(x.a, x.b) < std::tie(y.a, y.b); }
};

Edge edge_of(std::uint32_t a, std::uint32_t b) { return a < b ? Edge{a, b} : Edge{b, a}; }

class EdgeSplitter {
 public:
  EdgeSplitter(TriSurface& surface, float max_edge) : surface_(surface), max2_(max_edge * max_edge) {}

  /// One round: every edge that is too long gets a midpoint, shared by its triangles, so no T-junction arises.
  bool round() {
    std::vector<Edge> longs;
    for (const auto& t : surface_.triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        if (too_long(t[i], t[(i + 1) % 3])) longs.push_back(edge_of(t[i], t[(i + 1) % 3]));
      }
    }
    if (longs.empty()) return false;
    std::sort(longs.begin(), longs.end());
    longs.erase(std::unique(longs.begin(), longs.end()), longs.end());
    edges_ = std::move(longs);
    first_ = static_cast<std::uint32_t>(surface_.vertices.size());
    for (const auto& e : edges_) add_midpoint(e);
    std::vector<Triangle> out;
    out.reserve(surface_.triangles.size() * 2);
    for (const auto& t : surface_.triangles) split(t, out);
    surface_.triangles = std::move(out);
    return true;
  }

 private:
  [[nodiscard]] bool too_long(std::uint32_t a, std::uint32_t b) const {
    return (surface_.vertices[a] - surface_.vertices[b]).squaredNorm() > max2_;
  }

  void add_midpoint(const Edge& e) {
    surface_.vertices.emplace_back(0.5F * (surface_.vertices[e.a] + surface_.vertices[e.b]));
    if (!surface_.normals.empty()) {
      surface_.normals.emplace_back((surface_.normals[e.a] + surface_.normals[e.b]).normalized());
    }
    if (!surface_.albedo.empty()) surface_.albedo.push_back(0.5F * (surface_.albedo[e.a] + surface_.albedo[e.b]));
    if (!surface_.material.empty()) surface_.material.push_back(surface_.material[e.a]);
  }

  [[nodiscard]] std::int64_t midpoint(std::uint32_t a, std::uint32_t b) const {
    const Edge e = edge_of(a, b);
    const auto it = std::lower_bound(edges_.begin(), edges_.end(), e);
    if (it == edges_.end() || *it != e) return -1;
    return static_cast<std::int64_t>(first_) + (it - edges_.begin());
  }

  void split(const Triangle& t, std::vector<Triangle>& out) const {
    std::array<std::int64_t, 3> m{midpoint(t[0], t[1]), midpoint(t[1], t[2]), midpoint(t[2], t[0])};
    const auto v = [](std::int64_t i) { return static_cast<std::uint32_t>(i); };
    const int n = (m[0] >= 0 ? 1 : 0) + (m[1] >= 0 ? 1 : 0) + (m[2] >= 0 ? 1 : 0);
    if (n == 0) {
      out.push_back(t);
    } else if (n == 3) {
      out.push_back({t[0], v(m[0]), v(m[2])});
      out.push_back({v(m[0]), t[1], v(m[1])});
      out.push_back({v(m[2]), v(m[1]), t[2]});
      out.push_back({v(m[0]), v(m[1]), v(m[2])});
    } else {
      // Rotate so that edge 0 is split and edge 2 is not.
      std::size_t r = 0;
      while (m[r] < 0 || m[(r + 2) % 3] >= 0) ++r;
      const std::uint32_t a = t[r], b = t[(r + 1) % 3], c = t[(r + 2) % 3], ab = v(m[r]);
      out.push_back({a, ab, c});
      if (n == 1) {
        out.push_back({ab, b, c});
      } else {
        const std::uint32_t bc = v(m[(r + 1) % 3]);
        out.push_back({ab, b, bc});
        out.push_back({ab, bc, c});
      }
    }
  }

  TriSurface& surface_;
  float max2_;
  std::vector<Edge> edges_;
  std::uint32_t first_ = 0;
};

}  // namespace

void compute_normals(TriSurface& surface) {
  surface.normals.assign(surface.vertices.size(), Vec3f::Zero());
  for (const auto& t : surface.triangles) {
    const Vec3f a = surface.vertices[t[0]], b = surface.vertices[t[1]], c = surface.vertices[t[2]];
    const Vec3f n = (b - a).cross(c - a);
    for (const std::uint32_t i : t) surface.normals[i] += n;
  }
  for (auto& n : surface.normals) {
    const float length = n.norm();
    n = length > 0 ? Vec3f(n / length) : Vec3f(Vec3f::UnitZ());
  }
}

void refine_edges(TriSurface& surface, double max_edge_mm) {
  EdgeSplitter splitter(surface, static_cast<float>(max_edge_mm));
  constexpr int kMaxRounds = 24;  // halves every edge each round: enough for any finite mesh
  for (int i = 0; i < kMaxRounds && splitter.round(); ++i) {
  }
}

std::size_t smooth_folds(TriSurface& surface) {
  std::size_t folded = 0;
  for (int round = 0;; ++round) {
    compute_normals(surface);
    std::vector<std::uint8_t> moves(surface.vertices.size(), 0);
    folded = 0;
    for (const auto& t : surface.triangles) {
      const Vec3f a = surface.vertices[t[0]];
      const Vec3f facet = (surface.vertices[t[1]] - a).cross(surface.vertices[t[2]] - a);
      const Vec3f about = surface.normals[t[0]] + surface.normals[t[1]] + surface.normals[t[2]];
      if (facet.dot(about) > 0) continue;
      ++folded;
      for (const std::uint32_t i : t) moves[i] = 1;
    }
    if (folded == 0 || round == kMaxFoldRounds) return folded;
    // What a few rounds did not mend needs room: its neighbours move as well.
    constexpr int kPatience = 4;
    if (round >= kPatience) {
      const auto core = moves;
      for (const auto& t : surface.triangles) {
        if (core[t[0]] + core[t[1]] + core[t[2]] == 0) continue;
        for (const std::uint32_t i : t) moves[i] = 1;
      }
    }
    std::vector<Vec3f> sum(surface.vertices.size(), Vec3f::Zero());
    std::vector<float> count(surface.vertices.size(), 0);
    for (const auto& t : surface.triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        if (moves[t[i]] == 0) continue;
        sum[t[i]] += surface.vertices[t[(i + 1) % 3]] + surface.vertices[t[(i + 2) % 3]];
        count[t[i]] += 2;
      }
    }
    for (std::size_t i = 0; i < moves.size(); ++i) {
      if (moves[i] != 0) surface.vertices[i] = sum[i] / count[i];
    }
  }
}

namespace {

/// Materials and film of `extra` behind those of `surface`, whose first `count` vertices may have none.
void append_looks(TriSurface& surface, const TriSurface& extra, std::size_t count) {
  const std::size_t all = surface.vertices.size();
  if (!surface.material.empty() || !extra.material.empty()) {
    surface.material.resize(count, 0);
    surface.material.insert(surface.material.end(), extra.material.begin(), extra.material.end());
    surface.material.resize(all, 0);
  }
  if (!surface.film.empty() || !extra.film.empty()) {
    surface.film.resize(count);
    surface.film.insert(surface.film.end(), extra.film.begin(), extra.film.end());
    surface.film.resize(all);
  }
}

}  // namespace

void append(TriSurface& surface, const TriSurface& extra) {
  const auto offset = static_cast<std::uint32_t>(surface.vertices.size());
  surface.vertices.insert(surface.vertices.end(), extra.vertices.begin(), extra.vertices.end());
  surface.normals.insert(surface.normals.end(), extra.normals.begin(), extra.normals.end());
  surface.albedo.insert(surface.albedo.end(), extra.albedo.begin(), extra.albedo.end());
  append_looks(surface, extra, offset);
  for (const auto& t : extra.triangles) surface.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
}

TriSurface tessellate(const Ball& ball, double edge_mm) {
  TriSurface out;
  out.vertices = {Vec3f(1, 0, 0), Vec3f(-1, 0, 0), Vec3f(0, 1, 0), Vec3f(0, -1, 0), Vec3f(0, 0, 1), Vec3f(0, 0, -1)};
  out.triangles = {{4, 0, 2}, {4, 2, 1}, {4, 1, 3}, {4, 3, 0}, {5, 2, 0}, {5, 1, 2}, {5, 3, 1}, {5, 0, 3}};
  const auto limit = static_cast<float>(edge_mm / ball.radius);
  for (bool again = true; again;) {
    EdgeSplitter splitter(out, limit);
    again = splitter.round();
    for (auto& v : out.vertices) v.normalize();
  }
  out.normals = out.vertices;
  out.albedo.assign(out.vertices.size(), ball.albedo);
  if (ball.material != 0) out.material.assign(out.vertices.size(), ball.material);
  for (auto& v : out.vertices) v = (v.cast<double>().normalized() * ball.radius + ball.centre).cast<float>();
  return out;
}

TriSurface truth_mesh(const Surroundings& surroundings, double ball_edge_mm) {
  TriSurface out = surroundings.mesh;
  for (const auto& ball : surroundings.balls) append(out, tessellate(ball, ball_edge_mm));
  return out;
}

}  // namespace enamel::twin
