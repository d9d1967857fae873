// What became of a known artefact, for the report.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "pipeline/register/map/artefact_tie.hpp"

namespace enamel::app {

/// `map.artefact` of the report.
[[nodiscard]] nlohmann::json artefact_json(const pipeline::ArtefactFacts& facts);
/// One line of the table, from that.
[[nodiscard]] std::string artefact_line(const nlohmann::json& artefact);

}  // namespace enamel::app
