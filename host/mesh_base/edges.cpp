#include "host/mesh_base/edges.hpp"

#include "pipeline/types/disjoint_sets.hpp"

namespace enamel::host {

std::unordered_map<std::uint64_t, std::uint32_t> directed_edges(std::span<const Triangle> triangles) {
  std::unordered_map<std::uint64_t, std::uint32_t> out;
  out.reserve(3 * triangles.size());
  for (std::uint32_t f = 0; f < triangles.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) out.try_emplace(edge_key(triangles[f][k], triangles[f][(k + 1) % 3]), f);
  return out;
}

namespace {

/// Calls with (face, corner k, other face) for every edge k -> k + 1 that another face has the other way round.
template <class Call>
void each_shared_edge(std::span<const Triangle> triangles, const Call& call) {
  const auto edges = directed_edges(triangles);
  for (std::uint32_t f = 0; f < triangles.size(); ++f) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto other = edges.find(edge_key(triangles[f][(k + 1) % 3], triangles[f][k]));
      if (other != edges.end() && other->second != f) call(f, k, other->second);
    }
  }
}

std::uint32_t corner_at(const Triangle& face, std::uint32_t vertex) {
  return face[0] == vertex ? 0U : face[1] == vertex ? 1U : 2U;
}

}  // namespace

Pieces pieces_of(std::span<const Triangle> triangles) {
  DisjointSets groups(triangles.size());
  each_shared_edge(triangles, [&](std::uint32_t f, std::uint32_t, std::uint32_t other) { groups.join(f, other); });
  Pieces out;
  out.of_face.resize(triangles.size());
  for (std::uint32_t f = 0; f < triangles.size(); ++f) {
    const std::uint32_t root = groups.root(f);
    out.of_face[f] = root == f ? out.count++ : out.of_face[root];
  }
  return out;
}

std::vector<std::uint32_t> fans_of(std::span<const Triangle> triangles) {
  DisjointSets groups(3 * triangles.size());
  each_shared_edge(triangles, [&](std::uint32_t f, std::uint32_t k, std::uint32_t other) {
    const Triangle &here = triangles[f], &there = triangles[other];
    for (const std::uint32_t corner : {k, (k + 1) % 3})
      groups.join(3 * f + corner, 3 * other + corner_at(there, here[corner]));
  });
  std::vector<std::uint32_t> out(3 * triangles.size());
  for (std::uint32_t c = 0; c < out.size(); ++c) out[c] = groups.root(c);
  return out;
}

}  // namespace enamel::host
