// Reader of Wavefront OBJ files.
#pragma once

#include <string_view>

#include "host/mesh_files/mesh_file.hpp"

namespace enamel::host {

[[nodiscard]] Result<MeshFile> parse_obj(std::string_view text);

}  // namespace enamel::host
