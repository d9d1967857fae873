// What `enamel calibrate solve` leaves behind: the report always, rig.json and its copy in the store when accepted.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "calib/io/calib_folder.hpp"
#include "calib/judge/judgement.hpp"
#include "calib/judge/step_effect.hpp"
#include "calib/solve/measure_folder.hpp"

namespace enamel::app {

struct Outcome {
  const calib::CalibFolder& folder;
  const calib::MeasuredFolder& measured;
  const calib::Solution& solution;
  const calib::Judgement& judgement;
  const std::vector<calib::StepEffect>& steps;
};

/// The text of the solved rig.json. Errors: those of solved_rig_text.
[[nodiscard]] Result<std::string> rig_text(const Outcome& outcome);

/// Writes STEM.html, for a person, and STEM.json with the same numbers and all residuals. `verdict`: verdict_json.
/// Errors: kFileWrite, kInternal.
[[nodiscard]] Result<void> write_report(const Outcome& outcome, nlohmann::ordered_json verdict,
                                        const std::string& stem);

}  // namespace enamel::app
