// A scanned surface made a solid: walls from its border down to a plane, a flat bottom, holes closed. All of that is
// made up, and tagged so.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "host/mesh_base/watertight.hpp"
#include "pipeline/types/mesh.hpp"
#include "protocol/base/result.hpp"

namespace enamel::host {

struct BaseConfig {
  std::optional<Vec3d> up = {};  ///< from the bottom to the teeth; none: where the surface as a whole looks
  double below_mm = 2.0;         ///< chosen: of the plane under the lowest point
  double least_share = 0.005;    ///< chosen: pieces of less of the surface are dust of a scan, left out and counted
  double hole_mm = 8.0;          ///< chosen: a hole of more way round is told apart as large: some 2.5 mm wide
};

/// The solid: first the measured vertices and faces, then what was made up. Measured vertices keep their place to the
/// bit; no normals, no quality.
struct ClosedMesh {
  Mesh mesh;
  std::size_t measured_vertices = 0, measured_faces = 0;
  Vec3d up = Vec3d::UnitZ();
  double plane_mm = 0;  ///< of the bottom along `up`

  std::uint64_t pieces = 0, left_out_pieces = 0;
  std::uint64_t left_out_faces = 0;  ///< of those pieces, and faces on edges of three faces and more
  std::uint64_t holes = 0, large_holes = 0;
  double wall_mm2 = 0, bottom_mm2 = 0, hole_mm2 = 0;
  std::uint64_t crossings = 0;  ///< where the border's shadow crosses itself: the walls lean there
  std::uint64_t folded = 0;     ///< triangles of the bottom that lie upon others
  Watertight check;             ///< of the whole

  [[nodiscard]] std::size_t synthetic_faces() const noexcept { return mesh.triangles.size() - measured_faces; }
};

/// Errors: kMeshInvalid where no piece of the surface has a border that looks up, or `up` has no length; kInternal
/// where the outcome is not watertight. Pure, deterministic, thread-safe.
[[nodiscard]] Result<ClosedMesh> close_base(const Mesh& surface, const BaseConfig& config);

/// For reports: counts, areas in mm2, volume in mm3, the plane.
[[nodiscard]] std::string base_json(const ClosedMesh& closed);

/// As files; `synthetic` is 1 for what was made up. PLY: property of vertices and faces. OBJ: groups `measured` and
/// `synthetic`. STL has no place for it: measured facets come first, and the header tells their number.
[[nodiscard]] std::string closed_ply(const ClosedMesh& closed);
[[nodiscard]] std::string closed_obj(const ClosedMesh& closed);
[[nodiscard]] std::string closed_stl(const ClosedMesh& closed);
/// By extension, as write_mesh. Errors: kMeshInvalid (extension), kFileWrite.
[[nodiscard]] Result<void> write_closed(const std::string& path, const ClosedMesh& closed);

}  // namespace enamel::host
