// The keys of [[mover]], [fog] and [lamp]: what comes and goes while the probe scans.
#pragma once

#include "tools/twin/scene/scene.hpp"

namespace enamel::twin {

void bind_passing(ConfigReader& reader, SceneConfig& config);

}  // namespace enamel::twin
