// What the code says about a segment's absolute order: the one thing in which pattern modes differ for the labelling.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "pipeline/decode/unwrap/order_messages.hpp"

namespace enamel::pipeline {

enum class Stance : std::uint8_t { kSilent, kAgrees, kContradicts };

/// Of each state of a segment (order_messages.hpp), nats.
using StateNats = std::array<float, kOrderStates>;

/// Measured once a burst for all segments of a SegmentList, whose indices it is asked by.
class CodeEvidence {
 public:
  CodeEvidence() = default;
  virtual ~CodeEvidence() = default;
  CodeEvidence(const CodeEvidence&) = delete;
  CodeEvidence& operator=(const CodeEvidence&) = delete;

  /// Absolute half-fringe cells of the projector's frame are 0 … cells() - 1.
  [[nodiscard]] virtual int cells() const = 0;

  /// Orders after which the code is the same again; 0: it never is.
  [[nodiscard]] virtual int repeats_after() const = 0;

  /// Negative log probability of what was seen if the segment lay in absolute cell first_cell, first_cell + 2, … (all
  /// within the frame), each capped by that of a segment whose code lies. A segment that says nothing costs nothing.
  virtual void costs(std::size_t segment, std::int32_t first_cell, std::span<float> out) const = 0;

  /// The same of all states of segments first, first + 1, ..., whose state 0 is absolute cell first_cells[0], ...; what
  /// is said of cells beyond the frame has no meaning.
  virtual void costs_of_states(std::size_t first, std::span<const std::int32_t> first_cells, StateNats* out) const {
    for (std::size_t k = 0; k < first_cells.size(); ++k) {
      const std::int32_t cell = first_cells[k], skipped = std::min(kStates, cell < 0 ? (1 - cell) / 2 : 0);
      const std::int32_t end = std::max(skipped, std::min(kStates, ((cells() - 1 - cell) >> 1) + 1));
      const auto from = static_cast<std::size_t>(skipped);
      out[k] = {};
      if (skipped == end) continue;
      costs(first + k, cell + 2 * skipped, std::span(out[k]).subspan(from, static_cast<std::size_t>(end) - from));
    }
  }

  /// Whether the segment's code is that of the absolute cell; kSilent when it is too faint to be asked.
  [[nodiscard]] virtual Stance stance(std::size_t segment, std::int32_t cell) const = 0;
};

}  // namespace enamel::pipeline
