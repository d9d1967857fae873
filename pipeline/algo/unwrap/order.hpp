// Absolute fringe order: the cheapest labelling of all pieces with one of the shifts that the depth range allows them,
// under the code's evidence. Neighbouring pieces of a surface prefer the same shift but may part at a price, so that a
// jump of a whole 2 pi, which no phase difference shows, is found by the code. A piece whose second-best labelling is
// nearly as cheap stays undecided: it is known relatively only and is rejected, never guessed.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/algo/phase/cell_signs.hpp"
#include "pipeline/algo/unwrap/cells.hpp"

namespace enamel::algo {

/// All costs are negative log probabilities.
struct OrderConfig {
  float outlier_cost = 4.6F;      ///< most that one piece's contradiction counts: 1 % of the pieces lie (edges, glints)
  float unseen_jump_cost = 6.9F;  ///< a 2 pi jump inside a linked surface: one in a thousand neighbours
  float decided_margin = 4.6F;    ///< second-best must be this much dearer: 1 % risk
  float out_of_range_cost = 30;
  int min_region_px = 64;  ///< smaller regions of one shift are specks
};

struct PieceOrder {
  std::int32_t shift = 0;
  bool decided = false;
  bool speck = false;
};

struct OrderResult {
  std::vector<PieceOrder> pieces;  ///< parallel to the list of pieces
  double agreeing_px = 0;          ///< pixels of decided pieces whose code has the sign of the labelling …
  double contradicting_px = 0;     ///< … and those that have the other

  struct Work {
    std::vector<float> unary, left, right, row, up, down;
    std::vector<std::int32_t> base, parent, size;
  } work;
};

/// Min-sum messages along rows (exact) and between rows (bounded by unseen_jump_cost). Fixed order, deterministic.
void find_orders(const std::vector<Piece>& pieces, std::int32_t components, const CellSigns& signs,
                 const OrderConfig& config, OrderResult& out);

}  // namespace enamel::algo
