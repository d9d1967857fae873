// Reader of PLY bodies.
#pragma once

#include <string_view>

#include "host/mesh_files/mesh_file.hpp"

namespace enamel::host {

[[nodiscard]] Result<MeshFile> parse_ply(std::string_view bytes);

}  // namespace enamel::host
