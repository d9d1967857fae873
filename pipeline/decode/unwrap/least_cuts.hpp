// Unwrapping without a code: the surface that is cut where it costs least. Every loop of neighbours is consistent;
// where a cut lies, two neighbours differ by whole turns more than their phases say: a depth edge.
#pragma once

#include "pipeline/decode/unwrap/cut_costs.hpp"
#include "pipeline/decode/unwrap/cut_flow.hpp"
#include "pipeline/decode/unwrap/flood.hpp"

namespace enamel::pipeline {

struct LeastCutsWork {  ///< kept between bursts; one thread's
  CutCosts costs;
  CutFlow flow;

  /// Pixels of a row that hang together by whole links.
  struct Run {
    std::size_t row = 0, begin = 0, end = 0;
    std::int32_t parent = 0, wraps = 0;  ///< of its region's forest: this run's zero over its parent's
    std::int32_t component = 0;          ///< parent in the forest of components
    std::int32_t number = 0;             ///< of the component
  };
  std::vector<Run> runs;
  std::vector<std::uint8_t> marks;
};

/// Fills `out.wraps` and `out.component` of every valid pixel and of those rejected for noise or at edges (kNoisy,
/// kEdge), which bridge what would else be holes: Phi = phase + 2 pi (wraps + k), one k for each region of valid pixels
/// that hangs together by its four neighbours. Components are the parts of it that hang together by links that are
/// likelier on one surface than not and not cut: between two components of one region k is the same as far as the least
/// cuts can tell. Deterministic. O(pixels), and the search of each residue.
void unwrap_by_least_cuts(const PhaseMaps& phase, const Carrier& carrier, const CutConfig& config, LeastCutsWork& work,
                          FloodMaps& out);

}  // namespace enamel::pipeline
