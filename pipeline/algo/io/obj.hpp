// Reader of Wavefront OBJ files.
#pragma once

#include <string_view>

#include "pipeline/algo/io/mesh_file.hpp"

namespace enamel::algo {

[[nodiscard]] Result<MeshFile> parse_obj(std::string_view text);

}  // namespace enamel::algo
