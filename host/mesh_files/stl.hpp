// Reader of STL files, binary and ascii.
#pragma once

#include <string_view>

#include "host/mesh_files/mesh_file.hpp"

namespace enamel::host {

[[nodiscard]] Result<MeshFile> parse_stl(std::string_view bytes);

}  // namespace enamel::host
