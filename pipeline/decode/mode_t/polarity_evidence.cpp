#include "pipeline/decode/mode_t/polarity_evidence.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "pipeline/decode/mode_t/chosen.hpp"
#include "pipeline/decode/mode_t/polarity_columns.hpp"

namespace enamel::pipeline {
namespace {

/// derived: in the middle, while b is unknown: var(D -+ S3) is 4 sigma^2 for b = +1, 2 sigma^2 for b = -1.
constexpr float kNoiseOfCode = 3;

/// A register of every instruction set that we build for (a vector type of g++ and clang).
using Four [[gnu::vector_size(16)]] = float;

PolaritySaid say(const PolarityColumn* columns, SegmentCore core) {
  PolarityColumn s;
  for (std::int32_t u = core.begin; u < core.end; ++u) {
    const PolarityColumn& c = columns[u];
    s.dot += c.dot, s.energy += c.energy, s.noise += c.noise, s.blur += c.blur;
  }
  PolaritySaid said;
  if (!(s.energy > 1e-3F)) return said;
  const float inverse = 1 / s.energy, blur = kBlurError * s.blur * inverse;
  said.code = s.dot * inverse;
  said.variance = kNoiseOfCode * s.noise * inverse * inverse + blur * blur;
  return said;
}

}  // namespace

void PolarityEvidence::measure(const PhaseMaps& phase, const NoiseModel& noise, const std::vector<Segment>& segments,
                               const CellSigns& signs, float outlier_cost) {
  signs_ = &signs;
  split_signs();
  const auto width = static_cast<std::size_t>(phase.phase_rad.width());
  columns_.resize(width);
  said_.resize(segments.size());
  std::int32_t row = -1;
  for (std::size_t k = 0; k < segments.size(); ++k) {
    if (segments[k].row != row) {
      row = segments[k].row;
      polarity_columns(phase, noise, static_cast<std::size_t>(row) * width, width, columns_.data());
    }
    said_[k] = say(columns_.data(), core_of(segments, k, kPolarityEndTrim_px, phase.phase_rad.width()));
  }
  if (signs.informative) price_polarity(outlier_cost, said_.size(), said_.data());
}

void PolarityEvidence::costs(std::size_t segment, std::int32_t first_cell, std::span<float> out) const {
  const PolaritySaid& said = said_[segment];
  const float* sign = &signs_->sign[static_cast<std::size_t>(first_cell)];
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = sign[2 * k] > 0 ? said.plus : said.minus;
}

void PolarityEvidence::split_signs() {
  const std::size_t cells = signs_->sign.size();
  for (auto& half : halves_) half.assign((cells + 1) / 2 + 2 * kOrderStates, 0.0F);
  for (std::size_t cell = 0; cell < cells; ++cell) halves_[cell % 2][cell / 2 + kOrderStates] = signs_->sign[cell];
}

void PolarityEvidence::costs_of_states(std::size_t first, std::span<const std::int32_t> first_cells,
                                       StateNats* out) const {
  for (std::size_t k = 0; k < first_cells.size(); ++k) {
    const std::vector<float>& half = halves_[static_cast<std::size_t>(first_cells[k] & 1)];
    const auto last = static_cast<std::int32_t>(half.size() - kOrderStates);
    const float* sign = half.data() + std::clamp((first_cells[k] >> 1) + kStates, 0, last);
    const Four plus = Four{} + said_[first + k].plus, minus = Four{} + said_[first + k].minus;
    for (std::size_t j = 0; j < kOrderStates; j += 4) {
      Four here{};
      std::memcpy(&here, sign + j, sizeof here);
      here = here > Four{} ? plus : minus;
      std::memcpy(out[k].data() + j, &here, sizeof here);
    }
  }
}

Stance PolarityEvidence::stance(std::size_t segment, std::int32_t cell) const {
  const PolaritySaid& said = said_[segment];
  if (said.variance > kFaintVariance) return Stance::kSilent;
  return said.code * signs_->at(cell) > 0 ? Stance::kAgrees : Stance::kContradicts;
}

}  // namespace enamel::pipeline
