// The deviation for people: a coloured mesh and a picture.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/compare/compare.hpp"

namespace enamel::host {

/// Blue (below the reference) over white to red (above), saturated at +-limit.
[[nodiscard]] VertexColours deviation_colours(const std::vector<float>& deviation_um, double limit_um);

/// PNG: the mesh's vertices seen along its flattest direction, coloured, with a histogram and the figures below.
/// Empty for an empty mesh.
[[nodiscard]] std::vector<std::uint8_t> deviation_png(const Mesh& mesh, const CompareResult& result,
                                                      double limit_um = 100.0);

/// deviation.png and deviation.ply of a mesh, into a folder that is made. Errors: kFileWrite.
[[nodiscard]] Result<void> write_deviation(const std::string& folder, const MeshFile& mesh,
                                           const CompareResult& result);

}  // namespace enamel::host
