// The model after its scan: poses refined over all keyframes, every burst fused anew. Private to host/session.
#pragma once

#include <functional>

#include "calib/model/rig.hpp"
#include "host/session/end_joins.hpp"
#include "host/session/pipeline_config.hpp"
#include "host/session/scan_pipeline.hpp"

namespace enamel::host {

struct FinalMapInput {
  const calib::Rig& rig;  ///< that the bursts were measured with
  const PipelineConfig& config;
  std::size_t threads = 2;                               ///< never change the result
  std::function<void(double)> progress = [](double) {};  ///< share done, from the calling thread
};

/// Refines `placed`, the model's bursts in order, and rebuilds the model in `fuse` from them.
[[nodiscard]] MapFacts refine_model(const FinalMapInput& input, std::vector<MeasuredBurst>& placed,
                                    stage::FuseStage& fuse, const Clock& clock);

}  // namespace enamel::host
