// What a desktop scan can be told beside what every scan can, bound to TOML. docs: config/default.toml (generated).
#pragma once

#include <cstdint>
#include <optional>

#include "host/desktop/exposures.hpp"
#include "host/session/pipeline_config.hpp"
#include "pipeline/decode/triangulate/mean_patch.hpp"
#include "pipeline/register/stops/lay_stops.hpp"
#include "pipeline/register/stops/next_stop.hpp"
#include "pipeline/register/stops/table_relief.hpp"

namespace enamel::host {

struct DesktopConfig {
  PipelineConfig pipeline;  ///< decoder, ICP, fusion, mesh of every scan
  ExposureConfig exposures;
  pipeline::MeanConfig mean;
  pipeline::LayConfig lay;
  pipeline::ReliefConfig relief;
  pipeline::PlannerConfig planner;
  std::uint32_t calib_crc32 = 0;   ///< bursts that name another calibration are rejected; 0: any
  std::optional<double> above_mm;  ///< TableRelief: what lies lower goes
};

/// Binds the fields below the table `desktop`, with range and description: not `pipeline`, nor what a command is given.
void bind_desktop(ConfigReader& reader, DesktopConfig& config);

}  // namespace enamel::host
