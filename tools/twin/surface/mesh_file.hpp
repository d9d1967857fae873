// Triangle meshes in files: PLY, STL and OBJ in, PLY out. All values mm.
#pragma once

#include <span>
#include <string>

#include "protocol/base/result.hpp"
#include "tools/twin/surface/tri_surface.hpp"

namespace enamel::twin {

/// By extension; polygons are split into fans, unused vertices stay. Vertices of STL are merged when their coordinates
/// are equal. Normals are computed, albedo is `albedo`. Errors: kFileNotFound, kFileRead, kMeshInvalid (names what is
/// wrong).
[[nodiscard]] Result<TriSurface> load_mesh(const std::string& path, float albedo);

/// Parsers behind load_mesh, on the file's bytes. Errors: kMeshInvalid.
[[nodiscard]] Result<TriSurface> parse_ply(const std::string& bytes);
[[nodiscard]] Result<TriSurface> parse_stl(const std::string& bytes);
[[nodiscard]] Result<TriSurface> parse_obj(const std::string& bytes);

/// Binary little-endian PLY: x y z, uchar `seen`, uchar `material` and float `film_mm` a vertex, and faces. `seen` may
/// be empty, a mesh without materials or dry: then the property is absent.
[[nodiscard]] std::string write_ply(const TriSurface& mesh, std::span<const std::uint8_t> seen);

}  // namespace enamel::twin
