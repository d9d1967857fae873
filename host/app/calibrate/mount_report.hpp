// What a calibration of the axes says to a person and to a program.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "calib/mount/mount_solve.hpp"

namespace enamel::app {

/// Verdict, reasons, lines with their sigmas, stops. Refused where a line's direction or place is not known well
/// enough: 0.003 degrees, 3 um.
[[nodiscard]] nlohmann::ordered_json mount_json(const calib::MountSolution& solution);

/// A set that could not be solved.
[[nodiscard]] nlohmann::ordered_json unsolved_json(const Error& error, const std::vector<calib::StopNote>& unusable);

void print_mount(const nlohmann::ordered_json& json);

/// One HTML page; `json` is that of mount_json.
[[nodiscard]] std::string mount_page(const calib::MountSolution& solution, const nlohmann::ordered_json& json);

/// Angle and distance of both lines of two mounts, within 30 mm of the field's middle.
[[nodiscard]] nlohmann::ordered_json mount_difference_json(const calib::Mount& a, const calib::Mount& b);

}  // namespace enamel::app
