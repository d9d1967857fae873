// The places of a scan's defects, for people.
#pragma once

#include <cstdint>
#include <vector>

#include "host/defects/defect.hpp"
#include "pipeline/types/mesh.hpp"

namespace enamel::host {

/// PNG: the mesh seen along its flattest direction, each defect ringed with its number, and below a line for each.
/// A ring is dashed where its place lies on the far side. Empty for a mesh without vertices.
[[nodiscard]] std::vector<std::uint8_t> defects_png(const Mesh& mesh, const std::vector<Defect>& defects);

}  // namespace enamel::host
