// The coverage as a picture for the person who holds the target.
#pragma once

#include <string>

#include "calib/guide/coverage.hpp"

namespace enamel::calib {

/// PNG: the field with the dots of all poses, depth over pose, lean of each pose; SIMULATED written across when it is.
/// Errors: kFileWrite. The file appears whole or not at all.
[[nodiscard]] Result<void> write_coverage_picture(const std::vector<SeenPose>& poses, const Coverage& coverage,
                                                  const Rig& nominal, bool is_simulated, const std::string& path);

}  // namespace enamel::calib
