// A scene's materials and saliva, put on its body.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "tools/twin/scene/scene.hpp"

namespace enamel::twin {

/// What the effects leave of the materials; all plain when the body is plaster.
[[nodiscard]] MaterialTable effective_materials(const SceneConfig& config);
/// The jaw with the reflectances of its materials.
[[nodiscard]] JawConfig jaw_of_look(const SceneConfig& config);
/// Sets materials, their albedo and film of the body's surfaces. Texture comes after it.
void apply_look(const SceneConfig& config, Body& body);
/// Adds materials, and which teeth have which, to the truth's description. Nothing for plaster.
void describe_look(const SceneConfig& config, const Body& body, nlohmann::json& scene);

}  // namespace enamel::twin
