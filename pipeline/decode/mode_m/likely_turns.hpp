// Turns of all pieces, decided or not, for whoever needs the shape of a surface before its orders are sure. Private to
// pipeline/decode.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/decode/unwrap/cells.hpp"
#include "pipeline/decode/unwrap/order.hpp"
#include "pipeline/types/map.hpp"

namespace enamel::pipeline {

/// One burst's; keeps its memory between bursts. Not thread-safe.
struct LikelyTurns {
  Map<std::int16_t> turn;  ///< Phi = phase + 2 pi turn; kNoTurn outside all pieces

  struct Vote {
    std::int32_t component, shift, pixels;
  };
  std::vector<Vote> votes;                ///< of decided pieces
  std::vector<std::int32_t> most_common;  ///< shift of each component; kNobodyDecided
};

/// Of an undecided piece the shift that most decided pixels of its component have, since a surface goes on; its own
/// cheapest where none is decided. turn: resized to width x height. components: their number.
void find_likely_turns(std::span<const Piece> pieces, std::span<const PieceOrder> orders, std::int32_t components,
                       int width, int height, LikelyTurns& out);

}  // namespace enamel::pipeline
