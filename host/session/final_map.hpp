// The model after its scan: poses refined over all keyframes, every burst fused anew. Private to host/session.
#pragma once

#include <functional>

#include "calib/model/rig.hpp"
#include "host/defects/survey.hpp"
#include "host/session/end_joins.hpp"
#include "host/session/pipeline_config.hpp"
#include "host/session/scan_pipeline.hpp"

namespace enamel::host {

struct FinalMapInput {
  const calib::Rig& rig;  ///< that the bursts were measured with
  const PipelineConfig& config;
  std::size_t threads = 2;                               ///< never change the result
  std::function<void(double)> progress = [](double) {};  ///< share done, from the calling thread
  pipeline::EdgeMemo* memo = nullptr;                    ///< of edges that were measured before, or null
};

struct Refined {
  MapFacts facts;
  std::vector<pipeline::KeptBurst>
      history;                      ///< the model's bursts with their refined poses; empty where it stayed as it was
  std::vector<PassedPoint> passed;  ///< of the points left out, one a square of kPassedStepPx
  pipeline::BowVector bow_taken_out = pipeline::BowVector::Zero();  ///< of all its patches
};
inline constexpr int kPassedStepPx = 8;  ///< chosen: 0.3 to 0.5 mm on the object

/// Burst n of `kept` as the final model holds it. From several threads at once.
[[nodiscard]] SurfacePatch final_patch(const Refined& kept, std::size_t n, const calib::Rig& rig,
                                       stage::FuseStage& fuse);

/// Refines `placed`, the model's bursts in order, and rebuilds the model in `fuse` from them.
[[nodiscard]] Refined refine_model(const FinalMapInput& input, std::vector<MeasuredBurst>& placed,
                                   stage::FuseStage& fuse, const Clock& clock);

}  // namespace enamel::host
