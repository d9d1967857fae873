// What the stage graph knows of its stages, in the words of the screen.
#pragma once

#include "pipeline/flow/graph.hpp"
#include "pipeline/types/preview.hpp"

namespace enamel::host {

/// Of the stages between the graph's ends: sources and sinks only hand over.
[[nodiscard]] PipelineFigures figures_of(const flow::GraphSnapshot& snapshot);

}  // namespace enamel::host
