// A drawn burst as an exchange folder with its truth, for readers and judges that share no code with this project.
#pragma once

#include <string>

#include "protocol/base/result.hpp"
#include "tests/support/draw/render.hpp"

namespace enamel::test {

/// The unit as rig.json (rig/1).
[[nodiscard]] std::string rig_json(const calib::Rig& rig);

/// Writes rig.json, bursts.csv, frames/ and truth/ of one burst, number 0, into `folder`, made when absent. Error:
/// kFileWrite.
[[nodiscard]] Result<void> write_folder(const Drawn& drawn, const DrawnBurst& burst, const std::string& folder);

}  // namespace enamel::test
