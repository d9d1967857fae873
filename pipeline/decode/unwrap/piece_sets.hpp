// Which pieces hang together: neighbourhood and disjoint sets of a list of pieces.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "pipeline/decode/unwrap/cells.hpp"

namespace enamel::pipeline {

/// Calls visit(other) for the pieces linked to piece i of the list that come before it, and for those above and below.
template <class Visit>
void each_neighbour(const Piece& piece, std::size_t i, Visit visit) {
  if (piece.joined && !piece.kink) visit(i - 1);
  if (piece.up >= 0) visit(static_cast<std::size_t>(piece.up));
  if (piece.down >= 0) visit(static_cast<std::size_t>(piece.down));
}

/// Disjoint sets; the first of a set in the list is its root. Uses the caller's memory, for as long as that lives.
class PieceSets {
 public:
  PieceSets(std::size_t pieces, std::vector<std::int32_t>& parent) : parent_(parent) {
    parent_.resize(pieces);
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  std::size_t root(std::size_t i) {
    while (static_cast<std::size_t>(parent_[i]) != i) {
      parent_[i] = parent_[static_cast<std::size_t>(parent_[i])];
      i = static_cast<std::size_t>(parent_[i]);
    }
    return i;
  }

  void unite(std::size_t a, std::size_t b) {
    a = root(a), b = root(b);
    if (a != b) parent_[std::max(a, b)] = static_cast<std::int32_t>(std::min(a, b));
  }

 private:
  std::vector<std::int32_t>& parent_;
};

}  // namespace enamel::pipeline
