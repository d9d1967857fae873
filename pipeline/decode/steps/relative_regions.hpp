// What the code does not place: regions of segments whose orders hang together and are known relatively only.
#pragma once

#include <span>
#include <vector>

#include "pipeline/decode/phase/phase.hpp"
#include "pipeline/decode/phase/phase_ripple.hpp"
#include "pipeline/decode/unwrap/cells.hpp"
#include "pipeline/decode/unwrap/order.hpp"
#include "pipeline/types/relative_surface.hpp"

namespace enamel::pipeline {

/// Undecided segments that continue each other without a step make a region; regions under min_region_px are left out.
/// Fills spans and regions. parent: memory kept between bursts.
void find_relative(std::span<const Segment> segments, std::span<const SegmentOrder> orders, int min_region_px,
                   std::vector<std::int32_t>& parent, RelativeSurface& out);

/// The spans as cells, for the corrections of mode M.
void cells_of(const RelativeSurface& relative, std::vector<CellSpan>& out);

/// Fills phase_rad, less the ripple, and sigma_rad from the maps.
void take_phase(const PhaseMaps& maps, const PhaseRipple& ripple, RelativeSurface& out);

}  // namespace enamel::pipeline
