// The detectors. Private to host/defects.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "host/defects/inspect.hpp"
#include "host/defects/surface_cells.hpp"

namespace enamel::host::defects {

inline constexpr double kDefectUmPerMm = 1e3;

/// What several detectors need of a mesh.
struct Surface {
  const Mesh& mesh;
  SurfaceCells cells;
  std::vector<BorderLoop> loops;
  std::vector<double> from_rim_mm;  ///< of each cell
};

[[nodiscard]] inline Vec3d place_of(const Surface& s, std::uint32_t cell) {
  return s.mesh.vertices[s.cells.vertex[cell]].cast<double>();
}

void find_holes(const Surface& surface, const InspectConfig& config, std::vector<Defect>& out);
void find_bridges(const Surface& surface, const InspectConfig& config, std::vector<Defect>& out);
void find_noise(const Surface& surface, const InspectConfig& config, std::vector<Defect>& out);

/// The way that the surface about a place faces, walls beside it left out.
struct Facing {
  Vec3d axis = Vec3d::UnitZ(), middle = Vec3d::Zero();
};
[[nodiscard]] std::optional<Facing> facing_about(const Surface& surface, const Vec3d& about, double reach_mm);

struct Seen {
  const Surface& surface;
  const SurveyResult& survey;
};
void find_stitching(const Seen& seen, const InspectConfig& config, std::vector<Defect>& out);
void find_tissue(const Seen& seen, const InspectConfig& config, std::vector<Defect>& out);
void find_unreliable(const Seen& seen, const InspectConfig& config, std::vector<Defect>& out);
void find_humidity(const Seen& seen, const InspectConfig& config, std::vector<Defect>& out);

void check_scan_body(const Surface& surface, const ScanBodyMark& mark, const InspectConfig& config,
                     std::vector<Defect>& out);
void check_finish_line(const Surface& surface, const PreparationMark& mark, const InspectConfig& config,
                       std::vector<Defect>& out);

/// Rms of the vertices about the quadric that fits them best, by cell, um; negative where too few are around.
[[nodiscard]] std::vector<double> roughness_um(const Surface& surface);
/// By cell: what a quarter of the cells about it do not exceed. Folds and edges are rough in places, noise is
/// everywhere.
[[nodiscard]] std::vector<double> smoothest_quarter(const Surface& surface, const std::vector<double>& rough);
/// Distance to the other side of the sheet, by cell, mm; infinite where none is near.
[[nodiscard]] std::vector<double> thickness_mm(const Surface& surface, double within_mm);

}  // namespace enamel::host::defects
