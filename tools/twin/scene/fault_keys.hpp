// The keys of a scene's [fault].
#pragma once

#include "protocol/base/config.hpp"
#include "tools/twin/scene/scene.hpp"

namespace enamel::twin {

void bind_fault(ConfigReader& reader, SceneConfig& config);

}  // namespace enamel::twin
