// Keys of a body's materials, of what a mouth has in it, and of saliva.
#pragma once

#include "tools/twin/scene/scene.hpp"

namespace enamel::twin {

/// object.material, [mouth], [film] and [materials.*]; checks that they go together.
void bind_look(ConfigReader& reader, SceneConfig& config);

}  // namespace enamel::twin
