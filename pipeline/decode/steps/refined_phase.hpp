// Fourth step of a burst: the best absolute phase that all four frames give, motion and harmonics undone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "pipeline/decode/phase/phase.hpp"
#include "pipeline/types/map.hpp"

namespace enamel::pipeline {

/// Phi = phase_rad + 2 pi wraps of the pixels that are not rejected. Borrowed from the workspace, valid until the next
/// burst.
struct RefinedPhase {
  const PhaseMaps& maps;
  const Map<std::int16_t>& wraps;
  /// Pixels solved from other frames than at first: what was shown of them is out of date.
  std::span<const std::size_t> solved_anew;
};

}  // namespace enamel::pipeline
