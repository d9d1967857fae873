// What report.json says of a desktop scan under "desktop". Keys: docs/desktop-scan.md.
#pragma once

#include <optional>
#include <string>

#include "host/desktop/desktop_model.hpp"
#include "host/desktop/stop_plan.hpp"
#include "pipeline/register/stops/lay_stops.hpp"

namespace enamel::host {

struct DesktopSeconds {
  double stops = 0, laying = 0;  ///< wall time: part of the report, not of any hash
};

/// An object. `laid`: of the model's stops that saw something, in their order.
[[nodiscard]] std::string desktop_json(const DesktopModel& model, const pipeline::LaidStops& laid,
                                       const DesktopSeconds& seconds, const std::optional<PlanOutcome>& plan);

/// One line of it for people.
[[nodiscard]] std::string desktop_line(const pipeline::LaidStops& laid, const std::optional<PlanOutcome>& plan);

}  // namespace enamel::host
