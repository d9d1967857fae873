#include "pipeline/decode/unwrap/least_cuts.hpp"

#include <algorithm>

#include "pipeline/decode/unwrap/byte_runs.hpp"
#include "pipeline/decode/unwrap/cut_rows.hpp"

namespace enamel::pipeline {
namespace {

/// Runs of a row hang together by links that are supported and not cut; regions by any links, components by such.
class Assembler {
 public:
  Assembler(LeastCutsWork& work, FloodMaps& out)
      : costs_(work.costs), flow_(work.flow), runs_(work.runs), marks_(work.marks), out_(out) {
    constexpr std::uint8_t kSentinel = 255;  // layout: ends every run
    runs_.clear();
    marks_.assign(costs_.stride + kRunPadding, kSentinel);
  }

  void run() {
    std::size_t above = 0;
    for (std::size_t v = 0; v + 2 < costs_.rows; ++v) {
      const std::size_t first = runs_.size();
      split_row(v);
      border(v, above, first);
      above = first;
    }
    number();
  }

 private:
  using Run = LeastCutsWork::Run;

  [[nodiscard]] std::size_t margin_index(std::size_t v) const { return (v + 1) * costs_.stride + 1; }
  [[nodiscard]] std::size_t width() const { return costs_.stride - 2; }

  void split_row(std::size_t v) {
    const std::size_t at = margin_index(v), w = width(), to = v * w;
    mark_segments({&costs_.valid[at], &costs_.east_turn[at], &costs_.east_cost[at], &flow_.east()[at]}, w,
                  marks_.data());
    std::int32_t wraps = 0;
    for (std::size_t u = 0, end = 0; u < w; u = end) {
      if (marks_[u] == kNoPixel) {
        end = std::min(end_of_run(marks_.data(), u, kNoPixel), w);
        std::fill(&out_.wraps[to + u], &out_.wraps[to + u] + (end - u), std::int16_t{0});
        continue;
      }
      end = std::min(end_of_run(marks_.data(), u + 1, kSameRun), w);
      const bool linked = costs_.valid[at + u - 1] != 0;
      const std::int32_t gained = linked ? costs_.east_turn[at + u - 1] + flow_.east()[at + u - 1] : 0;
      const bool whole = linked && costs_.east_cost[at + u - 1] > kLeastCost && flow_.east()[at + u - 1] == 0;
      wraps = whole ? wraps + gained : 0;
      if (!whole) {
        const auto self = static_cast<std::int32_t>(runs_.size());
        const std::int32_t last = linked ? out_.wraps[to + u - 1] : 0;
        runs_.push_back({v, u, end, self, 0, self});
        if (linked) join(self - 1, self, last + gained);
      }
      runs_.back().end = end;
      std::fill(&out_.wraps[to + u], &out_.wraps[to + u] + (end - u), static_cast<std::int16_t>(wraps));
    }
  }

  /// Runs of row v, from `first` on, with those of the row above it.
  void border(std::size_t v, std::size_t above, std::size_t first) {
    const std::size_t w = width();
    for (std::size_t k = first, o = above; k < runs_.size(); ++k) {
      while (o < first && runs_[o].end <= runs_[k].begin) ++o;
      for (std::size_t p = o; p < first && runs_[p].begin < runs_[k].end; ++p) {
        const std::size_t begin = std::max(runs_[p].begin, runs_[k].begin), end = std::min(runs_[p].end, runs_[k].end);
        const std::size_t link = margin_index(v - 1) + begin, to = v * w + begin;
        const std::int32_t gained = costs_.south_turn[link] + flow_.south()[link];
        join(static_cast<std::int32_t>(p), static_cast<std::int32_t>(k), out_.wraps[to - w] + gained - out_.wraps[to]);
        for (std::size_t i = 0; i < end - begin; ++i) {
          if (costs_.south_cost[link + i] <= kLeastCost || flow_.south()[link + i] != 0) continue;
          unite(static_cast<std::int32_t>(p), static_cast<std::int32_t>(k));
          break;
        }
      }
    }
  }

  Run& at(std::int32_t r) { return runs_[static_cast<std::size_t>(r)]; }

  /// Root of the region, with path halving; `wraps` of the run's zero over the root's is added up.
  std::int32_t root(std::int32_t r, std::int32_t& wraps) {
    while (at(r).parent != r) {
      Run& run = at(r);
      const Run& parent = at(run.parent);
      run.wraps += parent.parent != run.parent ? parent.wraps : 0;
      run.parent = parent.parent;
      wraps += run.wraps;
      r = run.parent;
    }
    return r;
  }

  /// The second run's zero lies `wraps` over the first's. Where they hang together already, that is known.
  void join(std::int32_t first, std::int32_t second, std::int32_t wraps) {
    std::int32_t first_wraps = 0, second_wraps = 0;
    const std::int32_t a = root(first, first_wraps), b = root(second, second_wraps);
    if (a == b) return;
    const std::int32_t b_over_a = first_wraps + wraps - second_wraps;
    at(std::max(a, b)).wraps = a < b ? b_over_a : -b_over_a;
    at(std::max(a, b)).parent = std::min(a, b);
  }

  std::int32_t component(std::int32_t r) {
    while (at(r).component != r) {
      at(r).component = at(at(r).component).component;
      r = at(r).component;
    }
    return r;
  }

  void unite(std::int32_t first, std::int32_t second) {
    const std::int32_t a = component(first), b = component(second);
    at(std::max(a, b)).component = std::min(a, b);
  }

  /// Components in row order, and the wrap counts of their runs.
  void number() {
    constexpr std::int32_t kNone = -1;  // layout: no component
    std::fill(out_.component.pixels().begin(), out_.component.pixels().end(), kNone);
    out_.components = 0;
    for (std::size_t k = 0; k < runs_.size(); ++k) {
      std::int32_t wraps = 0;
      root(static_cast<std::int32_t>(k), wraps);
      Run& run = runs_[k];
      const std::int32_t top = component(static_cast<std::int32_t>(k));
      run.number = static_cast<std::size_t>(top) == k ? out_.components++ : at(top).number;
      const std::size_t begin = run.row * width() + run.begin, end = run.row * width() + run.end;
      std::fill(&out_.component[begin], &out_.component[begin] + (end - begin), run.number);
      if (wraps == 0) continue;
      for (std::size_t i = begin; i < end; ++i) out_.wraps[i] = static_cast<std::int16_t>(out_.wraps[i] + wraps);
    }
  }

  const CutCosts& costs_;
  const CutFlow& flow_;
  std::vector<Run>& runs_;
  std::vector<std::uint8_t>& marks_;
  FloodMaps& out_;
};

}  // namespace

void unwrap_by_least_cuts(const PhaseMaps& phase, const Carrier& carrier, const CutConfig& config, LeastCutsWork& work,
                          FloodMaps& out) {
  const int w = phase.phase_rad.width(), h = phase.phase_rad.height();
  if (out.wraps.width() != w || out.wraps.height() != h) out.wraps = Map<std::int16_t>(w, h);
  if (out.component.width() != w || out.component.height() != h) out.component = Map<std::int32_t>(w, h);
  measure_cut_costs(phase, carrier, config, work.costs);
  work.flow.settle(work.costs);
  Assembler(work, out).run();
}

}  // namespace enamel::pipeline
