// Whether a mesh is closed, and how large it is.
#pragma once

#include <cstdint>
#include <map>
#include <utility>

#include "pipeline/types/mesh.hpp"

namespace enamel::pipeline {

struct EdgeUse {
  int forward = 0, backward = 0;
};

inline std::map<std::pair<std::uint32_t, std::uint32_t>, EdgeUse> edges_of(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, EdgeUse> edges;
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k];
      const std::uint32_t b = t[(k + 1) % 3];
      (a < b ? edges[{a, b}].forward : edges[{b, a}].backward) += 1;
    }
  }
  return edges;
}

/// Edges that are not used exactly once in each direction.
inline std::size_t open_or_crowded_edges(const Mesh& mesh) {
  std::size_t bad = 0;
  for (const auto& [edge, use] : edges_of(mesh)) {
    bad += use.forward == 1 && use.backward == 1 ? 0U : 1U;
  }
  return bad;
}

inline std::size_t crowded_edges(const Mesh& mesh) {
  std::size_t bad = 0;
  for (const auto& [edge, use] : edges_of(mesh)) {
    bad += use.forward > 1 || use.backward > 1 ? 1U : 0U;
  }
  return bad;
}

inline double volume(const Mesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const auto p = [&](std::size_t k) -> Vec3d { return mesh.vertices[t[k]].cast<double>(); };
    sum += p(0).dot(p(1).cross(p(2))) / 6.0;
  }
  return sum;
}

}  // namespace enamel::pipeline
