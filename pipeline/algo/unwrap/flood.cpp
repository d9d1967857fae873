#include "pipeline/algo/unwrap/flood.hpp"

#include <algorithm>
#include <utility>

#include "pipeline/algo/phase/poly_trig.hpp"

namespace enamel::algo {
namespace {

constexpr std::int32_t kNil = -1;

int turn_between(float from, float to) {
  const float d = to - from;
  return (d < -kPiF ? 1 : 0) - (d > kPiF ? 1 : 0);
}

class Joiner {
 public:
  Joiner(const Map<float>& phase, const LinkMaps& links, FloodMaps& out)
      : phase_(phase), links_(links), out_(out), width_(static_cast<std::size_t>(phase.width())) {
    out_.work.runs.clear();
    out_.work.joints.clear();
    out_.work.head.fill(kNil);
  }

  void run() {
    for (int v = 0; v < phase_.height(); ++v) {
      split_row(v);
      if (v > 0) border_rows(static_cast<std::size_t>(v - 1) * width_);
    }
    for (std::size_t bucket = out_.work.head.size(); bucket-- > 0;) {
      for (std::int32_t k = out_.work.head[bucket]; k != kNil; k = out_.work.joints[static_cast<std::size_t>(k)].next)
        join(out_.work.joints[static_cast<std::size_t>(k)]);
    }
    number();
  }

 private:
  /// Runs of a row; `component` holds the run's index for now, `turn` is relative to the run's first pixel.
  void split_row(int v) {
    const std::size_t at = static_cast<std::size_t>(v) * width_;
    auto& runs = out_.work.runs;
    int turn = 0;
    for (std::size_t u = 0; u < width_; ++u) {
      const std::size_t i = at + u;
      const int quality = links_.quality[i];
      if (quality == 0) {
        out_.component[i] = kNil;
        continue;
      }
      const bool linked = u > 0 && links_.east[i - 1] != 0;
      const bool clean = linked && ((quality | links_.quality[i - 1]) & kCleanQuality) != 0;
      const int step = linked ? turn_between(phase_[i - 1], phase_[i]) : 0;
      const auto x = static_cast<std::int32_t>(u);
      if (clean) {
        turn += step;
        runs.back().end = x + 1;
      } else {
        const auto self = static_cast<std::int32_t>(runs.size());
        if (linked) add({self - 1, self, turn + step, kNil}, weight(i - 1, i));
        turn = 0;
        runs.push_back({v, x, x + 1, self, 1, 0});
      }
      out_.turn[i] = static_cast<std::int16_t>(turn);
      out_.component[i] = static_cast<std::int32_t>(runs.size()) - 1;
    }
  }

  /// Joints between the row that begins at `at` and the one below, neighbouring pixels that say the same as one.
  void border_rows(std::size_t at) {
    FloodMaps::Joint open;
    int sum = 0;
    for (std::size_t i = at; i < at + width_; ++i) {
      if (links_.south[i] == 0) continue;
      const std::size_t j = i + width_;
      const std::int32_t a = out_.component[i], b = out_.component[j];
      const std::int32_t turn = out_.turn[i] + turn_between(phase_[i], phase_[j]) - out_.turn[j];
      if (sum > 0 && (a != open.first || b != open.second || turn != open.turn)) {
        add(open, sum);
        sum = 0;
      }
      open = {a, b, turn, kNil};
      sum += weight(i, j);
    }
    if (sum > 0) add(open, sum);
  }

  int weight(std::size_t i, std::size_t j) const {
    constexpr int kLevel = kCleanQuality - 1;
    return std::min(links_.quality[i] & kLevel, links_.quality[j] & kLevel);
  }

  void add(FloodMaps::Joint joint, int weight) {
    constexpr int kWeightPerBucket = 16;  // half a good pixel's: single pixels come last, 128 good ones first
    const auto bucket = static_cast<std::size_t>(std::min(weight / kWeightPerBucket, 255));
    joint.next = std::exchange(out_.work.head[bucket], static_cast<std::int32_t>(out_.work.joints.size()));
    out_.work.joints.push_back(joint);
  }

  /// Root of a run, with path halving; `turn` of the run's zero over the root's is added up.
  std::int32_t root(std::int32_t r, std::int32_t& turn) {
    auto& runs = out_.work.runs;
    while (runs[static_cast<std::size_t>(r)].parent != r) {
      FloodMaps::Run& run = runs[static_cast<std::size_t>(r)];
      const FloodMaps::Run& parent = runs[static_cast<std::size_t>(run.parent)];
      run.turn += parent.parent != run.parent ? parent.turn : 0;
      run.parent = parent.parent;
      turn += run.turn;
      r = run.parent;
    }
    return r;
  }

  void join(const FloodMaps::Joint& joint) {
    auto& runs = out_.work.runs;
    std::int32_t first_turn = 0, second_turn = 0;
    std::int32_t a = root(joint.first, first_turn), b = root(joint.second, second_turn);
    if (a == b) return;  // agreed already, or a conflict that better links have decided
    std::int32_t b_over_a = first_turn + joint.turn - second_turn;
    if (runs[static_cast<std::size_t>(a)].size < runs[static_cast<std::size_t>(b)].size) {
      std::swap(a, b);
      b_over_a = -b_over_a;
    }
    FloodMaps::Run& child = runs[static_cast<std::size_t>(b)];
    child.parent = a;
    child.turn = b_over_a;
    runs[static_cast<std::size_t>(a)].size += child.size;
  }

  void number() {
    auto& runs = out_.work.runs;
    out_.components = 0;
    auto& numbers = out_.work.numbers;
    numbers.assign(runs.size(), kNil);
    for (std::size_t k = 0; k < runs.size(); ++k) {
      std::int32_t turn = 0;
      const auto top = static_cast<std::size_t>(root(static_cast<std::int32_t>(k), turn));
      if (numbers[top] == kNil) numbers[top] = out_.components++;
      const std::size_t at = static_cast<std::size_t>(runs[k].row) * width_;
      const std::size_t begin = at + static_cast<std::size_t>(runs[k].begin);
      const std::size_t end = at + static_cast<std::size_t>(runs[k].end);
      std::fill(&out_.component[begin], &out_.component[begin] + (end - begin), numbers[top]);
      for (std::size_t i = begin; i < end; ++i) out_.turn[i] = static_cast<std::int16_t>(out_.turn[i] + turn);
    }
  }

  const Map<float>& phase_;
  const LinkMaps& links_;
  FloodMaps& out_;
  std::size_t width_;
};

}  // namespace

void flood(const Map<float>& phase_rad, const LinkMaps& links, FloodMaps& out) {
  if (out.turn.width() != phase_rad.width() || out.turn.height() != phase_rad.height())
    out.turn = Map<std::int16_t>(phase_rad.width(), phase_rad.height());
  if (out.component.size() != phase_rad.size() || out.component.width() != phase_rad.width())
    out.component = Map<std::int32_t>(phase_rad.width(), phase_rad.height());
  Joiner(phase_rad, links, out).run();
}

}  // namespace enamel::algo
