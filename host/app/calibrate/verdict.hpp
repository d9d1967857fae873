// What `enamel calibrate` says of a calibration: one JSON object, and the same in words.
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <vector>

#include "calib/judge/judgement.hpp"
#include "calib/report/report.hpp"

namespace enamel::app {

[[nodiscard]] nlohmann::ordered_json notes_json(const std::vector<calib::PoseNote>& notes);
[[nodiscard]] nlohmann::ordered_json planes_json(const std::vector<calib::PlaneCheck>& planes);

/// sag_um, twist_um and their standard errors at 1/8, 1/2 and 7/8 of the depth range.
void add_shapes(nlohmann::ordered_json& json, const std::array<calib::DepthShape, 3>& shapes);

[[nodiscard]] nlohmann::ordered_json steps_json(const std::vector<calib::StepEffect>& steps);

/// [{"name", "value", "sigma" (null where unknown), "unit"}]
[[nodiscard]] nlohmann::ordered_json parameters_json(const std::vector<calib::RigParameter>& parameters);

/// The keys of cli.md, `calibrate solve --json`, and more.
[[nodiscard]] nlohmann::ordered_json verdict_json(const calib::Solution& s, const calib::Judgement& j);

/// The verdict on stdout: as it stands, or in words.
void show_verdict(const nlohmann::ordered_json& json, bool as_json);

}  // namespace enamel::app
