// A ray of the projector lights one place: where it meets the first surface. So no two pieces of a row can have the
// same columns, and what lies behind another piece is dark. Said of a row as if it were an epipolar line: where those
// lean by a few degrees, places are compared that lie a few rows apart, on mostly the same surfaces. Private to
// pipeline/decode.
#pragma once

#include <vector>

#include "pipeline/decode/unwrap/order.hpp"

namespace enamel::pipeline {

/// Chooses again for the pieces that label_rows left undecided: a shift at which a piece's columns are those of another
/// piece of its row costs as much more as that one is sure of them, at most config.lit_twice_cost. Decided pieces stay.
/// Uses up, down and margin of out.work, as label_rows left them.
void choose_by_columns(const std::vector<Piece>& pieces, int cells, const OrderConfig& config, OrderResult& out);

}  // namespace enamel::pipeline
