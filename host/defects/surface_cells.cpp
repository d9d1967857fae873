#include "host/defects/surface_cells.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "host/defects/place_grid.hpp"
#include "pipeline/types/disjoint_sets.hpp"

namespace enamel::host {
namespace {

std::uint64_t directed(std::uint32_t from, std::uint32_t to) { return std::uint64_t{from} << 32U | to; }

Vec3d at(const Mesh& mesh, std::uint32_t v) { return mesh.vertices[v].cast<double>(); }

/// Edges of faces that no other face runs along the other way, by their first vertex: sorted.
std::vector<std::uint64_t> open_edges(const Mesh& mesh) {
  std::vector<std::uint64_t> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) edges.push_back(directed(t[k], t[(k + 1) % 3]));
  std::ranges::sort(edges);
  std::vector<std::uint64_t> out;
  for (const std::uint64_t e : edges) {
    const std::uint64_t back = e << 32U | e >> 32U;
    if (!std::ranges::binary_search(edges, back)) out.push_back(e);
  }
  return out;
}

void measure(const Mesh& mesh, BorderLoop& loop) {
  const std::size_t n = loop.vertices.size();
  for (const std::uint32_t v : loop.vertices) loop.middle += at(mesh, v) / static_cast<double>(n);
  Vec3d area = Vec3d::Zero();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3d a = at(mesh, loop.vertices[i]), b = at(mesh, loop.vertices[(i + 1) % n]);
    loop.length_mm += (b - a).norm();
    area += 0.5 * (a - loop.middle).cross(b - loop.middle);
  }
  loop.area_mm2 = area.norm();
}

}  // namespace

SurfaceCells cells_of(const Mesh& mesh, double cell_mm) {
  SurfaceCells out;
  std::unordered_map<std::uint64_t, std::uint32_t> known;
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    const std::uint64_t key = place_key(place_index(at(mesh, v), cell_mm));
    const auto [found, is_new] = known.try_emplace(key, static_cast<std::uint32_t>(out.vertex.size()));
    if (is_new) out.vertex.push_back(v);
    out.of_vertex.push_back(found->second);
  }
  out.area_mm2.assign(out.vertex.size(), 0.0);
  std::vector<std::uint64_t> pairs;
  for (const auto& t : mesh.triangles) {
    const double third = (at(mesh, t[1]) - at(mesh, t[0])).cross(at(mesh, t[2]) - at(mesh, t[0])).norm() / 6.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = out.of_vertex[t[k]], b = out.of_vertex[t[(k + 1) % 3]];
      out.area_mm2[a] += third;
      if (a == b) continue;
      pairs.push_back(directed(a, b));
      pairs.push_back(directed(b, a));
    }
  }
  std::ranges::sort(pairs);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  out.first.assign(out.vertex.size() + 1, 0);
  for (const std::uint64_t p : pairs) {
    ++out.first[(p >> 32U) + 1];
    out.touches.push_back(static_cast<std::uint32_t>(p));
  }
  for (std::size_t c = 0; c < out.vertex.size(); ++c) out.first[c + 1] += out.first[c];
  return out;
}

std::vector<BorderLoop> border_loops(const Mesh& mesh) {
  const std::vector<std::uint64_t> open = open_edges(mesh);
  std::vector<bool> used(open.size(), false);
  std::vector<BorderLoop> out;
  const auto next_of = [&](std::uint32_t v) {
    auto found = std::ranges::lower_bound(open, directed(v, 0));
    while (found != open.end() && *found >> 32U == v && used[static_cast<std::size_t>(found - open.begin())]) ++found;
    return found != open.end() && *found >> 32U == v ? static_cast<std::size_t>(found - open.begin()) : open.size();
  };
  for (std::size_t begin = 0; begin < open.size(); ++begin) {
    if (used[begin]) continue;
    BorderLoop loop;
    for (std::size_t e = begin; e < open.size(); e = next_of(static_cast<std::uint32_t>(open[e]))) {
      used[e] = true;
      loop.vertices.push_back(static_cast<std::uint32_t>(open[e] >> 32U));
    }
    measure(mesh, loop);
    out.push_back(std::move(loop));
  }
  DisjointSets pieces(mesh.vertices.size());
  for (const auto& t : mesh.triangles) {
    pieces.join(t[0], t[1]);
    pieces.join(t[0], t[2]);
  }
  std::unordered_map<std::uint32_t, std::size_t> longest;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const auto [found, is_new] = longest.try_emplace(pieces.root(out[i].vertices.front()), i);
    if (!is_new && out[i].length_mm > out[found->second].length_mm) found->second = i;
  }
  for (const auto& [piece, loop] : longest) out[loop].is_outer = true;
  return out;
}

std::vector<double> distance_to_rim(const SurfaceCells& cells, std::span<const BorderLoop> loops) {
  std::vector<double> out(cells.size(), std::numeric_limits<double>::max());
  std::vector<std::uint32_t> front;
  for (const BorderLoop& loop : loops) {
    if (!loop.is_outer) continue;
    for (const std::uint32_t v : loop.vertices) {
      const std::uint32_t c = cells.of_vertex[v];
      if (out[c] != 0) front.push_back(c);
      out[c] = 0;
    }
  }
  for (double reached = kCellMm; !front.empty(); reached += kCellMm) {
    std::vector<std::uint32_t> next;
    for (const std::uint32_t c : front) {
      for (const std::uint32_t n : cells.touching(c)) {
        if (out[n] <= reached) continue;
        out[n] = reached;
        next.push_back(n);
      }
    }
    front = std::move(next);
  }
  return out;
}

std::vector<bool> majority(const SurfaceCells& cells, const std::vector<bool>& chosen) {
  std::vector<bool> out(cells.size(), false);
  for (std::uint32_t c = 0; c < cells.size(); ++c) {
    const auto around = cells.touching(c);
    const auto votes = std::ranges::count_if(around, [&](std::uint32_t n) { return chosen[n]; });
    out[c] = 2 * static_cast<std::size_t>(votes) > around.size();
  }
  return out;
}

std::vector<Region> regions(const Mesh& mesh, const SurfaceCells& cells,
                            const std::function<bool(std::uint32_t)>& chosen) {
  std::vector<bool> wanted(cells.size());
  for (std::uint32_t c = 0; c < cells.size(); ++c) wanted[c] = chosen(c);
  std::vector<Region> out;
  for (std::uint32_t start = 0; start < cells.size(); ++start) {
    if (!wanted[start]) continue;
    Region region;
    region.cells.push_back(start);
    wanted[start] = false;
    Vec3d sum = Vec3d::Zero();
    for (std::size_t i = 0; i < region.cells.size(); ++i) {
      const std::uint32_t c = region.cells[i];
      region.area_mm2 += cells.area_mm2[c];
      sum += at(mesh, cells.vertex[c]);
      for (const std::uint32_t n : cells.touching(c)) {
        if (!wanted[n]) continue;
        wanted[n] = false;
        region.cells.push_back(n);
      }
    }
    const Vec3d middle = sum / static_cast<double>(region.cells.size());
    region.middle = *std::ranges::min_element(
        region.cells, {}, [&](std::uint32_t c) { return (at(mesh, cells.vertex[c]) - middle).squaredNorm(); });
    out.push_back(std::move(region));
  }
  std::ranges::stable_sort(out, std::ranges::greater{}, &Region::area_mm2);
  return out;
}

}  // namespace enamel::host
