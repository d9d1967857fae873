// Triangles that close a border: the smallest surface over its vertices (Barequet & Sharir 1995). Private to
// host/mesh_base.
#pragma once

#include <functional>
#include <vector>

#include "host/mesh_base/edges.hpp"
#include "host/mesh_base/sheet.hpp"

namespace enamel::host {

/// Whether two vertices are joined by an edge already: a second one would have four faces.
using Joined = std::function<bool(std::uint32_t, std::uint32_t)>;

/// Faces run against the border's, so that each edge of it has two. A border of more than some hundred vertices is cut
/// along short chords first. Where no surface of its own vertices is free of `joined` edges, a vertex in its middle is
/// appended to `vertices`. Deterministic.
[[nodiscard]] std::vector<Triangle> close_hole(const Loop& loop, std::vector<Vec3f>& vertices, const Joined& joined);

}  // namespace enamel::host
