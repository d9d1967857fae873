// The keys of [path]: how the probe moves.
#pragma once

#include "tools/twin/scene/scene.hpp"

namespace enamel::twin {

/// Binds [path] and rejects what does not fit together. Needs config.object.
void bind_path(ConfigReader& reader, SceneConfig& config);

}  // namespace enamel::twin
