// What a desktop scan can be told beside what every scan can.
#pragma once

#include <cstdint>
#include <optional>

#include "host/session/pipeline_config.hpp"
#include "pipeline/decode/triangulate/mean_patch.hpp"
#include "pipeline/register/stops/lay_stops.hpp"
#include "pipeline/register/stops/table_relief.hpp"

namespace enamel::host {

struct DesktopConfig {
  PipelineConfig pipeline;  ///< decoder, ICP, fusion, mesh of every scan
  pipeline::MeanConfig mean;
  pipeline::LayConfig lay;
  pipeline::ReliefConfig relief;
  std::uint32_t calib_crc32 = 0;   ///< bursts that name another calibration are rejected; 0: any
  std::optional<double> above_mm;  ///< TableRelief: what lies lower goes
};

}  // namespace enamel::host
