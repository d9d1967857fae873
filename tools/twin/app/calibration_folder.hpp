// A rendered calibration folder: what a solver gets, and the truth to judge it by.
#pragma once

#include <functional>
#include <string>

#include "tools/twin/scene/scene.hpp"

namespace enamel::twin {

/// Writes rig.json (nominal), target.json, poses/NN/*.png and truth/{rig.json,poses.csv} into `folder`, on a mount's
/// path axes.csv and truth/mount_true.json as well; it appears whole or not at all. on_pose is called after each pose.
/// Errors: those of BoardStage; kUsage when the folder exists and is not empty; kFileWrite.
[[nodiscard]] Result<void> write_calibration_folder(const SceneConfig& scene, const std::string& folder,
                                                    const std::function<void()>& on_pose);

}  // namespace enamel::twin
