#include "pipeline/decode/unwrap/flood.hpp"

#include <algorithm>
#include <utility>

#include "pipeline/decode/unwrap/byte_runs.hpp"
#include "pipeline/decode/unwrap/chosen.hpp"
#include "pipeline/decode/unwrap/flood_rows.hpp"

namespace enamel::pipeline {
namespace {

constexpr std::int32_t kNil = -1;  ///< layout: no run, no joint

class Joiner {
 public:
  Joiner(const Map<float>& phase, const LinkMaps& links, FloodMaps& out)
      : phase_(phase), links_(links), out_(out), work_(out.work), width_(static_cast<std::size_t>(phase.width())) {
    constexpr std::uint8_t kSentinel = 255;  // layout: ends every run
    work_.runs.clear();
    work_.joints.clear();
    work_.head.fill(kNil);
    work_.upper.resize(width_);
    work_.lower.resize(width_);
    work_.wrap_counts.resize(width_);
    work_.weights.resize(width_);
    work_.marks.assign(width_ + kRunPadding, kSentinel);
    work_.changes.assign(width_ + kRunPadding, kSentinel);
  }

  void run() {
    for (int v = 0; v < phase_.height(); ++v) {
      std::swap(work_.upper, work_.lower);
      split_row(v);
      if (v > 0) border_rows(static_cast<std::size_t>(v - 1) * width_);
    }
    for (std::size_t bucket = work_.head.size(); bucket-- > 0;) {
      for (std::int32_t k = work_.head[bucket]; k != kNil; k = work_.joints[static_cast<std::size_t>(k)].next)
        join(work_.joints[static_cast<std::size_t>(k)]);
    }
    number();
  }

 private:
  /// Runs of a row; `lower` holds each pixel's, `wraps` is relative to the run's first pixel.
  void split_row(int v) {
    const std::size_t at = static_cast<std::size_t>(v) * width_;
    std::uint8_t* marks = work_.marks.data();
    mark_runs(&phase_[at], &links_.east[at], &links_.quality[at], width_, marks);
    int wraps = 0;
    for (std::size_t u = 0, end = 0; u < width_; u = end) {
      if (marks[u] == kNoPixel) {
        end = end_of_run(marks, u, kNoPixel);
        std::fill(&work_.lower[u], &work_.lower[u] + (end - u), kNil);
        continue;
      }
      end = end_of_run(marks, u + 1, kSameRun);
      wraps = begin_or_wrap(v, at, u, wraps);
      work_.runs.back().end = static_cast<std::int32_t>(end);
      std::fill(&work_.lower[u], &work_.lower[u] + (end - u), static_cast<std::int32_t>(work_.runs.size()) - 1);
      std::fill(&out_.wraps[at + u], &out_.wraps[at + u] + (end - u), static_cast<std::int16_t>(wraps));
    }
  }

  /// The wrap count of pixel u, where the phase wraps or a run begins, if that of the pixel before it is `wraps`.
  int begin_or_wrap(int v, std::size_t at, std::size_t u, int wraps) {
    const std::size_t i = at + u;
    const bool linked = u > 0 && links_.east[i - 1] != 0;
    const int next = linked ? wraps + wraps_between(phase_[i - 1], phase_[i]) : 0;
    if (linked && ((links_.quality[i] | links_.quality[i - 1]) & kCleanQuality) != 0) return next;
    const auto self = static_cast<std::int32_t>(work_.runs.size()), x = static_cast<std::int32_t>(u);
    if (linked) add({self - 1, self, next, kNil}, weight(i - 1, i));
    work_.runs.push_back({v, x, x, self, 1, 0});
    return 0;
  }

  /// Joints between the row that begins at `at` and the one below, neighbouring pixels that say the same as one.
  void border_rows(std::size_t at) {
    const std::size_t below = at + width_;
    compare_runs({&phase_[at], &links_.quality[at], &out_.wraps[at], work_.upper.data()},
                 {&phase_[below], &links_.quality[below], &out_.wraps[below], work_.lower.data()}, &links_.south[at],
                 width_, {work_.wrap_counts.data(), work_.weights.data(), work_.changes.data()});
    FloodMaps::Joint open;
    int sum = 0;
    for (std::size_t u = 0, end = 0; u < width_; u = end) {
      end = end_of_run(work_.changes.data(), u + 1, 0);
      int weight = 0;
      for (std::size_t k = u; k < end; ++k) weight += work_.weights[k];
      if (weight == 0) continue;
      const FloodMaps::Joint here{work_.upper[u], work_.lower[u], work_.wrap_counts[u], kNil};
      if (sum > 0 && (here.first != open.first || here.second != open.second || here.wraps != open.wraps)) {
        add(open, sum);
        sum = 0;
      }
      open = here;
      sum += weight;
    }
    if (sum > 0) add(open, sum);
  }

  int weight(std::size_t i, std::size_t j) const {
    constexpr int kLevel = kCleanQuality - 1;  // layout: bits of the level
    return std::min(links_.quality[i] & kLevel, links_.quality[j] & kLevel);
  }

  void add(FloodMaps::Joint joint, int weight) {
    const auto bucket = static_cast<std::size_t>(std::min(weight / kWeightPerBucket, 255));
    joint.next = std::exchange(work_.head[bucket], static_cast<std::int32_t>(work_.joints.size()));
    work_.joints.push_back(joint);
  }

  /// Root of a run, with path halving; `wraps` of the run's zero over the root's is added up.
  std::int32_t root(std::int32_t r, std::int32_t& wraps) {
    auto& runs = work_.runs;
    while (runs[static_cast<std::size_t>(r)].parent != r) {
      FloodMaps::Run& run = runs[static_cast<std::size_t>(r)];
      const FloodMaps::Run& parent = runs[static_cast<std::size_t>(run.parent)];
      run.wraps += parent.parent != run.parent ? parent.wraps : 0;
      run.parent = parent.parent;
      wraps += run.wraps;
      r = run.parent;
    }
    return r;
  }

  void join(const FloodMaps::Joint& joint) {
    auto& runs = work_.runs;
    std::int32_t first_wraps = 0, second_wraps = 0;
    std::int32_t a = root(joint.first, first_wraps), b = root(joint.second, second_wraps);
    if (a == b) return;  // agreed already, or a conflict that better links have decided
    std::int32_t b_over_a = first_wraps + joint.wraps - second_wraps;
    if (runs[static_cast<std::size_t>(a)].size < runs[static_cast<std::size_t>(b)].size) {
      std::swap(a, b);
      b_over_a = -b_over_a;
    }
    FloodMaps::Run& child = runs[static_cast<std::size_t>(b)];
    child.parent = a;
    child.wraps = b_over_a;
    runs[static_cast<std::size_t>(a)].size += child.size;
  }

  void number() {
    auto& runs = work_.runs;
    out_.components = 0;
    auto& numbers = work_.numbers;
    numbers.assign(runs.size(), kNil);
    std::int32_t* component = out_.component.pixels().data();
    std::size_t done = 0;  // pixels before it are numbered
    for (std::size_t k = 0; k < runs.size(); ++k) {
      std::int32_t wraps = 0;
      const auto top = static_cast<std::size_t>(root(static_cast<std::int32_t>(k), wraps));
      if (numbers[top] == kNil) numbers[top] = out_.components++;
      const std::size_t at = static_cast<std::size_t>(runs[k].row) * width_;
      const std::size_t begin = at + static_cast<std::size_t>(runs[k].begin);
      const std::size_t end = at + static_cast<std::size_t>(runs[k].end);
      std::fill(component + done, component + begin, kNil);
      std::fill(component + begin, component + end, numbers[top]);
      done = end;
      if (wraps == 0) continue;
      for (std::size_t i = begin; i < end; ++i) out_.wraps[i] = static_cast<std::int16_t>(out_.wraps[i] + wraps);
    }
    std::fill(component + done, component + out_.component.size(), kNil);
  }

  const Map<float>& phase_;
  const LinkMaps& links_;
  FloodMaps& out_;
  FloodMaps::Work& work_;
  std::size_t width_;
};

}  // namespace

void flood(const Map<float>& phase_rad, const LinkMaps& links, FloodMaps& out) {
  if (out.wraps.width() != phase_rad.width() || out.wraps.height() != phase_rad.height())
    out.wraps = Map<std::int16_t>(phase_rad.width(), phase_rad.height());
  if (out.component.size() != phase_rad.size() || out.component.width() != phase_rad.width())
    out.component = Map<std::int32_t>(phase_rad.width(), phase_rad.height());
  Joiner(phase_rad, links, out).run();
}

}  // namespace enamel::pipeline
