#include "pipeline/model/mesh/components.hpp"

#include <numeric>
#include <utility>
#include <vector>

namespace enamel::pipeline {
namespace {

// Disjoint sets with path halving; the smaller index is the root, so roots don't depend on the order of joins.
class Sets {
 public:
  explicit Sets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0U); }
  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) {
      parent_[i] = parent_[parent_[i]];
      i = parent_[i];
    }
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

void drop_unused_vertices(Mesh& mesh) {
  constexpr std::uint32_t kUnused = ~0U;
  std::vector<std::uint32_t> to(mesh.vertices.size(), kUnused);
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t v : t) {
      to[v] = 0;
    }
  }
  std::uint32_t next = 0;
  for (std::size_t v = 0; v < to.size(); ++v) {
    if (to[v] == kUnused) {
      continue;
    }
    to[v] = next;
    mesh.vertices[next] = mesh.vertices[v];
    if (!mesh.normals.empty()) {
      mesh.normals[next] = mesh.normals[v];
    }
    if (!mesh.quality.empty()) {
      mesh.quality[next] = mesh.quality[v];
    }
    ++next;
  }
  mesh.vertices.resize(next);
  mesh.normals.resize(mesh.normals.empty() ? 0 : next);
  mesh.quality.resize(mesh.quality.empty() ? 0 : next);
  for (auto& t : mesh.triangles) {
    t = {to[t[0]], to[t[1]], to[t[2]]};
  }
}

}  // namespace

ComponentStats remove_small_components(Mesh& mesh, std::uint32_t min_triangles) {
  Sets sets(mesh.vertices.size());
  for (const auto& t : mesh.triangles) {
    sets.join(t[0], t[1]);
    sets.join(t[1], t[2]);
  }
  std::vector<std::uint32_t> count(mesh.vertices.size(), 0);
  for (const auto& t : mesh.triangles) {
    ++count[sets.root(t[0])];
  }
  ComponentStats stats;
  for (const std::uint32_t n : count) {
    stats.components += n > 0 ? 1U : 0U;
    stats.removed += n > 0 && n < min_triangles ? 1U : 0U;
    stats.triangles_removed += n < min_triangles ? n : 0U;
  }
  std::erase_if(mesh.triangles, [&](const auto& t) { return count[sets.root(t[0])] < min_triangles; });
  drop_unused_vertices(mesh);
  return stats;
}

}  // namespace enamel::pipeline
