#include "host/mesh_base/watertight.hpp"

#include <algorithm>
#include <unordered_map>
#include <vector>

#include "host/mesh_base/edges.hpp"

namespace enamel::host {
namespace {

struct Uses {
  int along = 0, against = 0;  ///< of the edge from its lower to its higher vertex
};

void count_edges(const std::vector<Triangle>& triangles, Watertight& out) {
  std::unordered_map<std::uint64_t, Uses> edges;
  edges.reserve(2 * triangles.size());
  for (const Triangle& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      Uses& uses = edges[edge_key(std::min(a, b), std::max(a, b))];
      ++(a < b ? uses.along : uses.against);
    }
  }
  for (const auto& [key, uses] : edges) {
    const int faces = uses.along + uses.against;
    out.open_edges += faces == 1 ? 1U : 0U;
    out.crowded_edges += faces > 2 ? 1U : 0U;
    out.turned_edges += faces == 2 && uses.along != uses.against ? 1U : 0U;
  }
}

std::uint64_t count_pinched(const std::vector<Triangle>& triangles, std::size_t vertices) {
  const std::vector<std::uint32_t> fans = fans_of(triangles);
  std::vector<std::uint32_t> first(vertices, kNoIndex);
  std::vector<bool> pinched(vertices, false);
  for (std::size_t c = 0; c < fans.size(); ++c) {
    const std::uint32_t vertex = triangles[c / 3][c % 3];
    if (first[vertex] == kNoIndex) first[vertex] = fans[c];
    if (first[vertex] != fans[c]) pinched[vertex] = true;
  }
  return static_cast<std::uint64_t>(std::ranges::count(pinched, true));
}

/// Six times the signed volume that each piece encloses.
std::vector<double> volumes(const Mesh& mesh, const Pieces& pieces) {
  std::vector<double> out(pieces.count, 0.0);
  const Vec3d origin = mesh.vertices.front().cast<double>();
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    const auto at = [&](std::size_t k) -> Vec3d { return mesh.vertices[mesh.triangles[f][k]].cast<double>() - origin; };
    out[pieces.of_face[f]] += at(0).dot(at(1).cross(at(2)));
  }
  return out;
}

}  // namespace

Watertight check_watertight(const Mesh& mesh) {
  Watertight out;
  if (mesh.triangles.empty()) return out;
  for (const Triangle& t : mesh.triangles) out.flat_faces += t[0] == t[1] || t[1] == t[2] || t[2] == t[0] ? 1U : 0U;
  count_edges(mesh.triangles, out);
  out.pinched_vertices = count_pinched(mesh.triangles, mesh.vertices.size());
  const Pieces pieces = pieces_of(mesh.triangles);
  out.pieces = pieces.count;
  for (const double six_fold : volumes(mesh, pieces)) {
    out.volume_mm3 += six_fold / 6;
    out.inside_out += six_fold > 0 ? 0U : 1U;
  }
  return out;
}

std::string leaks_text(const Watertight& check) {
  std::string text;
  const auto add = [&](std::uint64_t count, const char* what) {
    if (count > 0) text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + what;
  };
  add(check.open_edges, "edges of one face");
  add(check.crowded_edges, "edges of three faces and more");
  add(check.turned_edges, "edges between faces that run the same way");
  add(check.pinched_vertices, "vertices where faces touch without an edge");
  add(check.flat_faces, "faces without area");
  add(check.inside_out, "pieces that are inside out");
  if (check.pieces == 0) text = "no surface";
  return text;
}

}  // namespace enamel::host
