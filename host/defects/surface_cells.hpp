// A mesh in cells: vertices nearer together than a defect is large count as one. Who borders whom, and how far from the
// edge of the scan. mm. Private to host/defects and its survey.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pipeline/types/mesh.hpp"

namespace enamel::host {

inline constexpr double kCellMm = 0.25;  ///< chosen: by judgement, a third of the least defect worth telling

/// Numbered in order of their first vertex. Same mesh, same cells.
struct SurfaceCells {
  std::vector<std::uint32_t> of_vertex;  ///< cell of each vertex of the mesh
  std::vector<std::uint32_t> vertex;     ///< of each cell: the first of its vertices, which stands for it
  std::vector<double> area_mm2;
  std::vector<std::uint32_t> first, touches;  ///< cells that cell c touches: touches[first[c] … first[c + 1])

  [[nodiscard]] std::size_t size() const noexcept { return vertex.size(); }
  [[nodiscard]] std::span<const std::uint32_t> touching(std::uint32_t cell) const {
    return std::span(touches).subspan(first[cell], first[cell + 1] - first[cell]);
  }
};

/// Precondition: indices of the mesh are valid, one normal a vertex.
[[nodiscard]] SurfaceCells cells_of(const Mesh& mesh, double cell_mm = kCellMm);

/// Borders of the mesh as loops of vertices in the order in which its faces run along them, and the piece that each is
/// of.
struct BorderLoop {
  std::vector<std::uint32_t> vertices;
  double length_mm = 0;
  double area_mm2 = 0;  ///< of the flat surface that fits best into it
  Vec3d middle = Vec3d::Zero();
  bool is_outer = false;  ///< the longest of its piece
};
[[nodiscard]] std::vector<BorderLoop> border_loops(const Mesh& mesh);

/// Steps from cell to cell to the nearest outer border, times kCellMm: about a distance on the surface, mm.
[[nodiscard]] std::vector<double> distance_to_rim(const SurfaceCells& cells, std::span<const BorderLoop> loops);

/// Cells that hang together and of which all are chosen, largest area first.
struct Region {
  std::vector<std::uint32_t> cells;
  double area_mm2 = 0;
  std::uint32_t middle = 0;  ///< the cell of it nearest to its centroid
};
[[nodiscard]] std::vector<Region> regions(const Mesh& mesh, const SurfaceCells& cells,
                                          const std::function<bool(std::uint32_t)>& chosen);

/// A chosen cell stays where more than half of the cells that it touches are chosen; others join in. Single cells that
/// stray over a limit are noise.
[[nodiscard]] std::vector<bool> majority(const SurfaceCells& cells, const std::vector<bool>& chosen);

}  // namespace enamel::host
