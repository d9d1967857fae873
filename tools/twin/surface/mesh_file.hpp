// Triangle meshes in files: PLY, STL and OBJ in, PLY out. All values mm.
#pragma once

#include <span>
#include <string>

#include "protocol/base/result.hpp"
#include "tools/twin/surface/tri_surface.hpp"

namespace enamel::twin {

/// What host/mesh_files reads; what it leaves out is logged. Normals are computed, albedo is `albedo`. Errors:
/// kFileNotFound, kFileRead, kMeshInvalid (names what is wrong; also a mesh more than 1 m from the origin).
[[nodiscard]] Result<TriSurface> load_mesh(const std::string& path, float albedo);

/// Binary little-endian PLY: x y z, uchar `seen`, uchar `material` and float `film_mm` a vertex, and faces. `seen` may
/// be empty, a mesh without materials or dry: then the property is absent.
[[nodiscard]] std::string write_ply(const TriSurface& mesh, std::span<const std::uint8_t> seen);

}  // namespace enamel::twin
