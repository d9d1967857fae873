#include "host/session/pipeline_figures.hpp"

#include <algorithm>
#include <utility>

#include "pipeline/flow/bottleneck.hpp"

namespace enamel::host {

PipelineFigures figures_of(const flow::GraphSnapshot& snapshot) {
  PipelineFigures out;
  out.bottleneck = flow::bottleneck_of(snapshot).words;
  std::vector<flow::StageLoad> loads = flow::loads_of(snapshot);
  for (std::size_t i = 0; i < loads.size(); ++i) {
    const flow::StageSnapshot& stage = snapshot.stages[i];
    flow::StageLoad& load = loads[i];
    const bool is_sink = std::none_of(snapshot.edges.begin(), snapshot.edges.end(), [&](const flow::EdgeSnapshot& e) {
      return e.from == stage.name && e.delay == 0;
    });
    if (stage.is_source || is_sink) continue;
    out.stages.push_back({.name = load.name,
                          .median_ms = 1e-6 * static_cast<double>(stage.service_ns.p50),
                          .p95_ms = 1e-6 * static_cast<double>(stage.service_ns.p95),
                          .rate_hz = load.rate_hz,
                          .busy = load.busy,
                          .queue_depth = load.queue_depth,
                          .queue_high_water = load.queue_high_water,
                          .queue_capacity = load.queue_capacity,
                          .waits_for = std::move(load.waits_for)});
  }
  return out;
}

}  // namespace enamel::host
