#include "host/mesh_base/sheet.hpp"

#include <algorithm>
#include <map>
#include <unordered_set>

namespace enamel::host {
namespace {

void weld(const Mesh& mesh, Sheet& out) {
  std::map<std::array<float, 3>, std::uint32_t> known;
  std::vector<std::uint32_t> index;
  for (const Vec3f& v : mesh.vertices) {
    const auto [at, fresh] = known.try_emplace({v.x() + 0.0F, v.y() + 0.0F, v.z() + 0.0F},  // -0 is 0
                                               static_cast<std::uint32_t>(out.vertices.size()));
    if (fresh) out.vertices.push_back(v);
    index.push_back(at->second);
  }
  for (const Triangle& t : mesh.triangles) out.triangles.push_back({index[t[0]], index[t[1]], index[t[2]]});
}

std::vector<bool> with_free_edges(const std::vector<Triangle>& triangles) {
  std::unordered_set<std::uint64_t> taken;
  taken.reserve(3 * triangles.size());
  std::vector<bool> kept(triangles.size(), false);
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    const Triangle& t = triangles[f];
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    const std::array keys{edge_key(t[0], t[1]), edge_key(t[1], t[2]), edge_key(t[2], t[0])};
    if (std::ranges::any_of(keys, [&](std::uint64_t key) { return taken.contains(key); })) continue;
    taken.insert(keys.begin(), keys.end());
    kept[f] = true;
  }
  return kept;
}

/// Of each vertex the fan with most faces; a face is kept where all three of its corners are of such.
std::vector<bool> in_largest_fans(const Sheet& sheet) {
  const std::vector<std::uint32_t> fans = fans_of(sheet.triangles);
  std::vector<std::uint32_t> size(fans.size(), 0);
  for (const std::uint32_t fan : fans) ++size[fan];
  std::vector<std::uint32_t> best(sheet.vertices.size(), kNoIndex);
  for (std::size_t c = 0; c < fans.size(); ++c) {
    std::uint32_t& of = best[sheet.triangles[c / 3][c % 3]];
    if (of == kNoIndex || size[fans[c]] > size[of]) of = fans[c];
  }
  std::vector<bool> kept(sheet.triangles.size(), true);
  for (std::size_t c = 0; c < fans.size(); ++c)
    if (best[sheet.triangles[c / 3][c % 3]] != fans[c]) kept[c / 3] = false;
  return kept;
}

}  // namespace

void keep_faces(Sheet& sheet, const std::vector<bool>& kept) {
  std::vector<Triangle> faces;
  for (std::size_t f = 0; f < kept.size(); ++f)
    if (kept[f]) faces.push_back(sheet.triangles[f]);
  std::vector<std::uint32_t> index(sheet.vertices.size(), kNoIndex);
  for (const Triangle& t : faces)
    for (const std::uint32_t v : t) index[v] = 0;
  std::vector<Vec3f> vertices;
  for (std::size_t v = 0; v < index.size(); ++v) {
    if (index[v] == kNoIndex) continue;
    index[v] = static_cast<std::uint32_t>(vertices.size());
    vertices.push_back(sheet.vertices[v]);
  }
  for (Triangle& t : faces) t = {index[t[0]], index[t[1]], index[t[2]]};
  sheet.vertices = std::move(vertices);
  sheet.triangles = std::move(faces);
}

Sheet clean_sheet(const Mesh& mesh) {
  Sheet out;
  weld(mesh, out);
  const std::size_t given = out.triangles.size();
  keep_faces(out, with_free_edges(out.triangles));
  for (;;) {  // a fan left out may pinch a vertex of its far side; ends since faces only go
    const std::vector<bool> kept = in_largest_fans(out);
    if (std::ranges::all_of(kept, [](bool keep) { return keep; })) break;
    keep_faces(out, kept);
  }
  out.left_out_faces = given - out.triangles.size();
  return out;
}

std::vector<Loop> borders(const Sheet& sheet) {
  const auto edges = directed_edges(sheet.triangles);
  std::vector<std::uint32_t> next(sheet.vertices.size(), kNoIndex);
  for (const Triangle& t : sheet.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      if (!edges.contains(edge_key(t[(k + 1) % 3], t[k]))) next[t[k]] = t[(k + 1) % 3];
  std::vector<Loop> out;
  for (std::uint32_t first = 0; first < next.size(); ++first) {
    if (next[first] == kNoIndex) continue;
    Loop loop;
    for (std::uint32_t at = first; next[at] != kNoIndex;) {
      loop.push_back(at);
      const std::uint32_t to = next[at];
      next[at] = kNoIndex;
      at = to;
    }
    out.push_back(std::move(loop));
  }
  return out;
}

}  // namespace enamel::host
