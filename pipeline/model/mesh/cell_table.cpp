#include "pipeline/model/mesh/cell_table.hpp"

#include <cstddef>

namespace enamel::pipeline {
namespace {

// Corners of each face, counter-clockwise seen from outside the cell.
constexpr std::array<std::array<unsigned, 4>, 6> kFace{
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

using Loop = std::vector<std::uint8_t>;

std::uint8_t edge_between(unsigned a, unsigned b) {
  for (std::uint8_t e = 0; e < 12; ++e) {
    const auto& edge = kCellEdge[e];
    if ((edge[0] == a && edge[1] == b) || (edge[0] == b && edge[1] == a)) {
      return e;
    }
  }
  return 0;  // not reached: neighbours on a face share an edge
}

bool share_face(std::uint8_t e, std::uint8_t f) {
  for (const auto& face : kFace) {
    const auto on = [&](std::uint8_t edge) {
      unsigned ends = 0;
      for (const unsigned corner : face) {
        ends += corner == kCellEdge[edge][0] || corner == kCellEdge[edge][1] ? 1U : 0U;
      }
      return ends == 2;
    };
    if (on(e) && on(f)) {
      return true;
    }
  }
  return false;
}

// On every face a directed segment from where the walk around it enters the inside to where it leaves: next[entry] =
// exit. An edge that is left on one face is entered on the other, so the segments chain into closed loops.
std::vector<Loop> loops_of(unsigned inside) {
  constexpr std::uint8_t kNone = 255;
  std::array<std::uint8_t, 12> next{};
  next.fill(kNone);
  const auto is_inside = [&](unsigned corner) { return ((inside >> corner) & 1U) != 0; };
  for (const auto& face : kFace) {
    for (unsigned k = 0; k < 4; ++k) {
      if (is_inside(face[k]) || !is_inside(face[(k + 1) % 4])) {
        continue;
      }
      unsigned last = k + 1;
      while (is_inside(face[(last + 1) % 4])) {
        ++last;
      }
      next[edge_between(face[k], face[(k + 1) % 4])] = edge_between(face[last % 4], face[(last + 1) % 4]);
    }
  }
  std::vector<Loop> loops;
  for (std::uint8_t start = 0; start < 12; ++start) {
    Loop loop;
    for (std::uint8_t e = start; next[e] != kNone;) {
      loop.push_back(e);
      const std::uint8_t to = next[e];
      next[e] = kNone;
      e = to;
    }
    if (!loop.empty()) {
      loops.push_back(loop);
    }
  }
  return loops;
}

// Triangulation of a loop with the fewest diagonals inside a face: dynamic programming over sub-polygons [i, j].
struct Cut {
  int cost = 0;
  std::size_t apex = 0;
};

void emit(const Loop& loop, const std::vector<std::vector<Cut>>& best, std::size_t i, std::size_t j,
          CellTriangles& out) {
  if (j < i + 2) {
    return;
  }
  const std::size_t k = best[i][j].apex;
  emit(loop, best, i, k, out);
  out.push_back({loop[i], loop[k], loop[j]});
  emit(loop, best, k, j, out);
}

void triangulate(const Loop& loop, CellTriangles& out) {
  const std::size_t n = loop.size();
  const auto price = [&](std::size_t i, std::size_t j) {
    const bool side = j == i + 1 || (i == 0 && j == n - 1);
    return !side && share_face(loop[i], loop[j]) ? 1 : 0;
  };
  std::vector<std::vector<Cut>> best(n, std::vector<Cut>(n));
  for (std::size_t length = 2; length < n; ++length) {
    for (std::size_t i = 0; i + length < n; ++i) {
      const std::size_t j = i + length;
      Cut& cut = best[i][j];
      cut.cost = 1000;
      for (std::size_t k = i + 1; k < j; ++k) {
        const int cost = best[i][k].cost + best[k][j].cost + price(i, k) + price(k, j);
        if (cost < cut.cost) {
          cut = Cut{cost, k};
        }
      }
    }
  }
  emit(loop, best, 0, n - 1, out);
}

std::array<CellTriangles, 256> make_table() {
  std::array<CellTriangles, 256> table;
  for (unsigned inside = 0; inside < 256; ++inside) {
    for (const Loop& loop : loops_of(inside)) {
      triangulate(loop, table[inside]);
    }
  }
  return table;
}

}  // namespace

const std::array<CellTriangles, 256>& cell_table() {
  static const std::array<CellTriangles, 256> table = make_table();
  return table;
}

}  // namespace enamel::pipeline
