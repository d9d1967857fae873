// Everything about the scan pipeline that can be configured, bound to TOML. docs: config/default.toml (generated).
#pragma once

#include "pipeline/algo/decode/burst_decoder.hpp"
#include "pipeline/algo/fuse/fuse_config.hpp"
#include "pipeline/algo/guide/model_guide.hpp"
#include "pipeline/algo/mesh/mesh_config.hpp"
#include "pipeline/algo/track/tracker.hpp"
#include "protocol/base/config.hpp"

namespace enamel::host {

struct PipelineConfig {
  algo::DecodeConfig decode;
  algo::TrackerConfig track;
  algo::GuideConfig guide;
  algo::FuseConfig fuse;
  algo::MeshConfig mesh;
  int feedback_delay = 2;  ///< bursts; registration of burst n uses the model after burst n - delay
  int preview_period = 2;
};

/// Binds all fields with range and description.
void bind(ConfigReader& reader, PipelineConfig& config);

}  // namespace enamel::host
