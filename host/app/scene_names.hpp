// Scenes of the twin by name: those of config/scenes beside the program.
#pragma once

#include <string>

#include "protocol/base/result.hpp"

namespace enamel::app {

/// A bare name (no slash, no .toml) is a scene that ships, anything else a path and returned as it is. Errors:
/// kFileNotFound, with the names that are known.
[[nodiscard]] Result<std::string> scene_file(const std::string& name_or_path);

}  // namespace enamel::app
