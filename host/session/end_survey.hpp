// The finished surface asked of all bursts that made it. Private to host/session.
#pragma once

#include <optional>
#include <vector>

#include "calib/model/rig.hpp"
#include "host/defects/survey.hpp"
#include "host/session/end_joins.hpp"
#include "host/session/final_map.hpp"

namespace enamel::host {

struct SurveyInput {
  const calib::Rig& rig;
  const Mesh& mesh;
  const std::vector<MeasuredBurst>& placed;
};

/// None where the bursts were not kept.
[[nodiscard]] std::optional<SurveyResult> survey_model(const SurveyInput& input, Refined kept, stage::FuseStage& fuse);

}  // namespace enamel::host
