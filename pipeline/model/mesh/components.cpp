#include "pipeline/model/mesh/components.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "pipeline/types/disjoint_sets.hpp"

namespace enamel::pipeline {
namespace {

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
    if (!mesh.soft.empty()) {
      mesh.soft[next] = mesh.soft[v];
    }
    ++next;
  }
  mesh.vertices.resize(next);
  mesh.normals.resize(mesh.normals.empty() ? 0 : next);
  mesh.quality.resize(mesh.quality.empty() ? 0 : next);
  mesh.soft.resize(mesh.soft.empty() ? 0 : next);
  for (auto& t : mesh.triangles) {
    t = {to[t[0]], to[t[1]], to[t[2]]};
  }
}

/// What is known of a piece, at its root.
struct Piece {
  std::uint32_t triangles = 0;
  SeenSpan seen{~std::uint64_t{0}, 0};
};

std::vector<Piece> pieces_of(const Mesh& mesh, std::span<const SeenSpan> seen, DisjointSets& sets) {
  for (const auto& t : mesh.triangles) {
    sets.join(t[0], t[1]);
    sets.join(t[1], t[2]);
  }
  std::vector<Piece> pieces(mesh.vertices.size());
  for (const auto& t : mesh.triangles) {
    Piece& piece = pieces[sets.root(t[0])];
    ++piece.triangles;
    if (seen.empty()) {
      continue;
    }
    for (const std::uint32_t v : t) {
      piece.seen.first = std::min(piece.seen.first, seen[v].first);
      piece.seen.last = std::max(piece.seen.last, seen[v].last);
    }
  }
  return pieces;
}

}  // namespace

ComponentStats remove_small_components(Mesh& mesh, const ComponentRules& rules, std::span<const SeenSpan> seen) {
  DisjointSets sets(mesh.vertices.size());
  const std::vector<Piece> pieces = pieces_of(mesh, seen, sets);
  std::uint32_t largest = 0;
  for (const Piece& piece : pieces) {
    largest = std::max(largest, piece.triangles);
  }
  const auto goes = [&](const Piece& piece) {
    const bool passed = !seen.empty() && piece.triangles < std::min(largest, rules.passing_triangles) &&
                        piece.seen.last - piece.seen.first < rules.passing_bursts;
    return piece.triangles > 0 && (piece.triangles < rules.min_triangles || passed);
  };
  ComponentStats stats;
  for (const Piece& piece : pieces) {
    stats.components += piece.triangles > 0 ? 1U : 0U;
    stats.removed += goes(piece) ? 1U : 0U;
    stats.triangles_removed += goes(piece) ? piece.triangles : 0U;
  }
  std::erase_if(mesh.triangles, [&](const auto& t) { return goes(pieces[sets.root(t[0])]); });
  drop_unused_vertices(mesh);
  return stats;
}

}  // namespace enamel::pipeline
