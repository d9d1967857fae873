// Reader of STL files, binary and ascii.
#pragma once

#include <string_view>

#include "pipeline/algo/io/mesh_file.hpp"

namespace enamel::algo {

[[nodiscard]] Result<MeshFile> parse_stl(std::string_view bytes);

}  // namespace enamel::algo
