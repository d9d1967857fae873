// Evidence of mode M. Over a segment, with w = B exp(i(phi + phi/L)) and phi wrapped, the code frame is
//   D = Re(w z),   z = g exp(i(2 pi k/L)),   g about 1,   k the absolute order (micro_code.hpp)
// z, two unknowns, is fitted by least squares: the residual of that fit is the same for every order, so z and its
// covariance hold all that the segment says about k. argmax over k of sum(D B c_k)/sqrt(sum((B c_k)^2)), the
// amplitude-free matched score, is the special case of an entirely unknown g >= 0 and equal
// noise.
#pragma once

#include <vector>

#include "pipeline/decode/mode_m/code_phasors.hpp"
#include "pipeline/decode/mode_m/micro_code.hpp"
#include "pipeline/decode/unwrap/cells.hpp"
#include "pipeline/decode/unwrap/code_evidence.hpp"
#include "pipeline/decode/unwrap/order.hpp"

namespace enamel::pipeline {

/// Sums of each pixel of one row; `out` has the row's width. Pixels without code have zeros.
void code_sums_of_row(const PhaseMaps& phase, const NoiseModel& noise, const MicroCode& code, std::size_t row,
                      CodeSumRow& out);

class MicroEvidence final : public CodeEvidence {
 public:
  /// `code` must outlive the questions. outlier_cost: of a segment whose code may be anything.
  void measure(const PhaseMaps& phase, const NoiseModel& noise, const std::vector<Segment>& segments,
               const MicroCode& code, float outlier_cost);

  [[nodiscard]] int cells() const override { return code_->cells; }
  [[nodiscard]] int repeats_after() const override { return code_->repeats_after; }
  void costs(std::size_t segment, std::int32_t first_cell, std::span<float> out) const override;
  void costs_of_states(std::size_t first, std::span<const std::int32_t> first_cells, StateNats* out) const override;

  /// Mean angle of the code against the decided orders, rad; stances are taken about it from then on. It is what motion
  /// between code frame and phase frames, or a cyclic permutation of the phase frames, does to all segments alike.
  float settle(const std::vector<Segment>& segments, const OrderResult& orders);

  /// A sharp z agrees when it lies within a third of a step of the order's angle, and is neither near 0 nor far too
  /// long. Where a tenth of the sharp ones are sharp enough for three sigma of noise within that third, only they are
  /// asked: the others' noise would pass for another code.
  [[nodiscard]] Stance stance(std::size_t segment, std::int32_t cell) const override;

 private:
  /// z turned back by the order of the cell.
  struct Turned {
    float along = 0, across = 0;
  };
  [[nodiscard]] Turned turned(std::size_t segment, std::int32_t cell) const;

  [[nodiscard]] float least_sharp() const;

  const MicroCode* code_ = nullptr;
  float least_sharp_ = 0;  ///< of what is asked
  Turned mean_{1, 0};      ///< direction of the code's mean angle
  CodeSumRow row_, segments_;
  CodePhasors said_;
  TurnTable turns_;
};

}  // namespace enamel::pipeline
