// Reader of PLY bodies.
#pragma once

#include <string_view>

#include "pipeline/algo/io/mesh_file.hpp"

namespace enamel::algo {

[[nodiscard]] Result<MeshFile> parse_ply(std::string_view bytes);

}  // namespace enamel::algo
