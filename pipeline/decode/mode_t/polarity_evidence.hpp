// Evidence of mode T (and of plain4, single): the polarity of frame 3 in a segment, T = sum(D S3)/sum(S3^2), about +1
// or -1 (docs/decode.md §2), against the signs of the pattern's cells.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/decode/mode_t/cell_signs.hpp"
#include "pipeline/decode/unwrap/cells.hpp"
#include "pipeline/decode/unwrap/code_evidence.hpp"

namespace enamel::pipeline {

/// A pixel's share in a segment's sums: D S3, S3^2, S3^2 var(frame), B |S3|.
struct PolarityColumn {
  float dot = 0, energy = 0, noise = 0, blur = 0;
};

struct PolaritySaid {
  float code = 0;             ///< T
  float variance = 1e9F;      ///< of T, noise and projector blur together
  float plus = 0, minus = 0;  ///< cost under each sign
};

class PolarityEvidence final : public CodeEvidence {
 public:
  /// `signs` must outlive the questions. outlier_cost: of a segment whose T may be anything.
  void measure(const PhaseMaps& phase, const NoiseModel& noise, const std::vector<Segment>& segments,
               const CellSigns& signs, float outlier_cost);

  [[nodiscard]] int cells() const override { return signs_->cells(); }
  [[nodiscard]] int repeats_after() const override { return signs_->repeats_after; }
  void costs(std::size_t segment, std::int32_t first_cell, std::span<float> out) const override;
  void costs_of_states(std::size_t first, std::span<const std::int32_t> first_cells, StateNats* out) const override;
  [[nodiscard]] Stance stance(std::size_t segment, std::int32_t cell) const override;

 private:
  void split_signs();

  const CellSigns* signs_ = nullptr;
  std::vector<PolaritySaid> said_;
  std::vector<PolarityColumn> columns_;  ///< of one row
  /// Signs of the even and of the odd cells, with kOrderStates more on either side, which nobody asks for.
  std::array<std::vector<float>, 2> halves_;
};

}  // namespace enamel::pipeline
