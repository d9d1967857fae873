// Everything about the scan pipeline that can be configured, bound to TOML. docs: config/default.toml (generated).
#pragma once

#include "pipeline/decode/burst_decoder.hpp"
#include "pipeline/model/fuse/fuse_config.hpp"
#include "pipeline/model/guide/model_guide.hpp"
#include "pipeline/model/mesh/mesh_config.hpp"
#include "pipeline/register/map/refine_map.hpp"
#include "pipeline/register/track/tracker.hpp"
#include "protocol/base/config.hpp"

namespace enamel::host {

struct PipelineConfig {
  pipeline::DecodeConfig decode;
  pipeline::TrackerConfig track;
  pipeline::GuideConfig guide;
  pipeline::FuseConfig fuse;
  pipeline::MeshConfig mesh;
  pipeline::MapConfig map;
  int feedback_delay = 2;  ///< bursts; registration of burst n uses the model after burst n - delay
  int preview_period = 2;
};

/// Binds all fields with range and description.
void bind(ConfigReader& reader, PipelineConfig& config);

}  // namespace enamel::host
