// Defects as a report of an earlier run has them, and meshes of other origin made ready to be inspected.
#pragma once

#include <string>
#include <vector>

#include "host/defects/defect.hpp"
#include "pipeline/types/mesh.hpp"
#include "protocol/base/result.hpp"

namespace enamel::host {

/// Of report.json: those that bursts told, not the mesh: stitching, tissue, reliability, humidity. What is not readable
/// as such is left out. Errors: kConfigSyntax when the text is no JSON object.
[[nodiscard]] Result<std::vector<Defect>> surveyed_defects(const std::string& report_json);

/// Area-weighted normals, one a vertex.
void add_normals(Mesh& mesh);

}  // namespace enamel::host
