// What a scan showed of a bow of the rig itself, for the report.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "pipeline/register/map/bow_find.hpp"

namespace enamel::app {

/// `map.bow` of the report.
[[nodiscard]] nlohmann::json bow_json(const pipeline::BowFacts& facts);
/// One line of the table, from that; empty where the scan tells nothing of it.
[[nodiscard]] std::string bow_line(const nlohmann::json& bow);

}  // namespace enamel::app
