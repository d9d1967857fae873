// Third step of a burst: the absolute fringe order of each segment of a region, as far as the code tells it.
#pragma once

#include <vector>

#include "pipeline/decode/phase/cell_span.hpp"
#include "pipeline/decode/phase/pixel_reject.hpp"
#include "pipeline/decode/unwrap/cells.hpp"
#include "pipeline/decode/unwrap/order.hpp"
#include "pipeline/types/map.hpp"

namespace enamel::pipeline {

/// Keeps its memory from burst to burst.
struct FringeOrders {
  SegmentList segments;
  OrderResult orders;           ///< parallel to the segments
  std::vector<CellSpan> spans;  ///< where decided segments lie; of find_spans

  /// Pixels whose code could be asked.
  [[nodiscard]] double judged_px() const noexcept { return orders.agreeing_px + orders.contradicting_px; }
  /// Of these, the share whose code is that of their order; 0 where none was asked.
  [[nodiscard]] double code_agreement() const noexcept;
  /// Share of smooth borders between half fringes at which the orders jump.
  [[nodiscard]] double torn_share() const noexcept;
};

/// A region's code is judged as a whole: what hangs together at one shift. Regions of which less than min_agreement of
/// the pixels whose code was asked agree with their order are decided no more. Returns the share of decided pixels that
/// this takes.
[[nodiscard]] double withdraw_contradicted(FringeOrders& orders, double min_agreement);

/// Fills `spans` from segments and orders.
void find_spans(FringeOrders& orders);

/// Rejects the pixels of all other segments: kRelative, or kSpeck of those too small to trust.
void reject_undecided(const FringeOrders& orders, Map<PixelReject>& reject);

/// Rejects (kEdge) pixels beside a jump of whole fringes inside a run, where the phase goes on as if there were none:
/// blur makes the pixels there see both sides, and the code places the jump to within a pixel.
void reject_beside_jumps(const FringeOrders& orders, Map<PixelReject>& reject);

}  // namespace enamel::pipeline
