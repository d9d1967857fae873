// A ray of the projector lights one place: where it meets the first surface. So no two segments of a row can have the
// same columns, and what lies behind another segment is dark. Said of a row as if it were an epipolar line: where those
// lean by a few degrees, places are compared that lie a few rows apart, on mostly the same surfaces. Private to
// pipeline/decode.
#pragma once

#include <vector>

#include "pipeline/decode/unwrap/order.hpp"

namespace enamel::pipeline {

/// Chooses again for the segments that label_rows left undecided: a shift at which a segment's columns are those of
/// another segment of its row costs as much more as that one is sure of them, at most config.lit_twice_cost. Decided
/// segments stay. Uses up, down and margin of out.work, as label_rows left them.
void choose_by_columns(const std::vector<Segment>& segments, int cells, const OrderConfig& config, OrderResult& out);

}  // namespace enamel::pipeline
