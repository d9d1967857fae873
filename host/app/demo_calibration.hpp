// The demo's calibration: a board rendered by the twin before the scene's rig, solved as a user would, kept in the
// cache.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/app/child_process.hpp"
#include "protocol/base/clock.hpp"
#include "protocol/base/result.hpp"

namespace enamel::app {

struct DemoCalibration {
  std::string nominal_rig;  ///< paths of rig files: what the probe left the factory with …
  std::string solved_rig;   ///< … and what its calibration made of it
};

/// Runs a program to its end; its exit code. Errors: kCancelled at a stop signal, kFileNotFound.
[[nodiscard]] Result<int> run_child(const std::vector<std::string>& argv, const ChildOptions& options, Clock& clock);

/// The same of one that must end with 0. Error besides: kInternal with its name and code.
[[nodiscard]] Result<void> run_or_fail(const std::vector<std::string>& argv, const ChildOptions& options, Clock& clock);

/// Folder calib-<key> of `cache`: the calibration folder, solved.json and solved.report.json; made when it is missing,
/// whole or not at all. The key covers the scene's rig, twin, solver and seed (`scene_key`: of everything but the
/// solver). Runs `enamel-twin calibrate` and `enamel calibrate solve`. Errors: kCancelled, kCalibrationRefused,
/// kFileWrite, kInternal.
[[nodiscard]] Result<DemoCalibration> demo_calibration(const std::string& scene, std::uint64_t seed,
                                                       const std::string& cache, const std::string& scene_key,
                                                       Clock& clock);

}  // namespace enamel::app
