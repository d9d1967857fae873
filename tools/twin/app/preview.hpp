// A look at the body itself, shaded like a dental model, without probe or patterns.
#pragma once

#include <string>

#include "tools/twin/scene/scene.hpp"

namespace enamel::twin {

/// Four views in one PNG: from above, from cheek, tongue and front. Errors: kFileWrite and those of the body.
[[nodiscard]] Result<void> write_preview(const SceneConfig& scene, const std::string& path);

}  // namespace enamel::twin
