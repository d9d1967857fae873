// The keys of [mount]: a desktop mount and its stops.
#pragma once

#include "tools/twin/scene/scene.hpp"

namespace enamel::twin {

/// Binds [mount] and rejects what does not fit together. Needs config.path.
void bind_mount(ConfigReader& reader, SceneConfig& config);

}  // namespace enamel::twin
