#include "pipeline/decode/unwrap/cut_holes.hpp"

#include <algorithm>

#include "pipeline/decode/unwrap/byte_runs.hpp"
#include "pipeline/decode/unwrap/cut_rows.hpp"

namespace enamel::pipeline {

/// Runs of invalid pixels. A run may go on from a row's end to the next row's beginning: both are margin, and outside.
void CutHoles::split_runs(const CutCosts& costs) {
  runs_.clear();
  const std::size_t n = costs.stride * costs.rows;
  for (std::size_t begin = 0, end = 0; begin < n; begin = end_of_run(costs.valid.data(), end, 1)) {
    end = end_of_run(costs.valid.data(), begin, 0);
    runs_.push_back({begin, end});
  }
}

/// Those that touch in one set.
void CutHoles::join_runs(SegmentSets& sets) const {
  for (std::size_t k = 0, o = 0; k < runs_.size(); ++k) {
    while (runs_[o].end + stride_ < runs_[k].begin) ++o;
    for (std::size_t p = o; p < k && runs_[p].begin + stride_ <= runs_[k].end; ++p) sets.unite(p, k);
  }
}

/// Torn quads by hole: counted, then placed.
void CutHoles::list_quads(const CutCosts& costs) {
  const std::size_t n = (costs.rows - 1) * costs.stride - 1;
  first_.assign(static_cast<std::size_t>(count_) + 2, 0);
  const auto each = [&](auto visit) {
    for (std::size_t q = end_of_run(torn_.data(), 0, 0); q < n; q = end_of_run(torn_.data(), q + 1, 0))
      if (const std::int32_t hole = of(q); hole != kOutside) visit(q, static_cast<std::size_t>(hole));
  };
  each([&](std::size_t, std::size_t hole) { ++first_[hole + 2]; });
  for (std::size_t h = 2; h < first_.size(); ++h) first_[h] += first_[h - 1];
  quads_.resize(static_cast<std::size_t>(first_.back()));
  each([&](std::size_t q, std::size_t hole) {
    quads_[static_cast<std::size_t>(first_[hole + 1]++)] = static_cast<std::int32_t>(q);
  });
}

void CutHoles::find(const CutCosts& costs) {
  constexpr std::uint8_t kSentinel = 255;  // layout: ends every run
  const std::size_t n = costs.stride * costs.rows;
  stride_ = costs.stride;
  valid_ = costs.valid.data();
  split_runs(costs);
  SegmentSets sets(runs_.size(), parent_);
  join_runs(sets);
  label_.resize(n);
  numbers_.assign(runs_.size(), 0);
  count_ = 0;
  for (std::size_t k = 0; k < runs_.size(); ++k) {
    const std::size_t top = sets.root(k);
    if (top == k) numbers_[k] = count_++;
    std::fill(label_.data() + runs_[k].begin, label_.data() + runs_[k].end, numbers_[top]);
  }
  torn_.assign(n + kRunPadding, kSentinel);
  for (std::size_t at = 0; at + costs.stride < n; at += costs.stride) {
    torn_row(&costs.valid[at], &costs.valid[at + costs.stride], costs.stride - 1, &torn_[at]);
    torn_[at + costs.stride - 1] = 0;  // no quad
  }
  list_quads(costs);
}

std::int32_t CutHoles::of(std::size_t quad) const noexcept {
  std::size_t p = quad;
  if (valid_[quad + 1] == 0) p = quad + 1;
  if (valid_[quad + stride_] == 0) p = quad + stride_;
  if (valid_[quad + stride_ + 1] == 0) p = quad + stride_ + 1;
  return label_[p];
}

std::span<const std::int32_t> CutHoles::quads(std::int32_t hole) const noexcept {
  const auto h = static_cast<std::size_t>(hole);
  return {quads_.data() + first_[h], static_cast<std::size_t>(first_[h + 1] - first_[h])};
}

}  // namespace enamel::pipeline
