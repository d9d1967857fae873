// What every reader demands of a mesh before it lets it in.
#pragma once

#include <string>

#include "pipeline/types/mesh.hpp"
#include "protocol/base/result.hpp"

namespace enamel::host {

/// Errors: kMeshInvalid: no vertex, no triangle, a coordinate that is not a finite number (or beyond 1e6 mm).
[[nodiscard]] Result<void> check_mesh(const Mesh& mesh, const std::string& format);

}  // namespace enamel::host
