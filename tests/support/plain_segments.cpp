// plain_steps.hpp: unwrapping. Kruskal's tree of the links between neighbours, the best first; what it joins is a
// segment.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include "tests/support/plain_steps.hpp"

namespace enamel::test::plain {
namespace {

constexpr double kMaxStep_rad = 0.6;  ///< between neighbours on one surface
constexpr std::size_t kMinSegment_px = 64;

/// Disjoint sets of pixels, each of which knows how many turns it lies above its set's root.
class TurnForest {
 public:
  explicit TurnForest(std::size_t pixels) : parent_(pixels), size_(pixels, 1), turns_(pixels, 0) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }

  struct Place {
    std::size_t root;
    int turns;
  };
  Place find(std::size_t i) {
    Place at{i, 0};
    for (; parent_[at.root] != at.root; at.root = parent_[at.root]) at.turns += turns_[at.root];
    for (int left = at.turns; parent_[i] != at.root;) {  // hang all on the way on the root; it is its own parent
      left -= std::exchange(turns_[i], left);
      i = std::exchange(parent_[i], at.root);
    }
    return at;
  }

  /// From now on b lies `step` turns above a, unless the two hang together already.
  void join(std::size_t a, std::size_t b, int step) {
    const Place of_a = find(a), of_b = find(b);
    if (of_a.root == of_b.root) return;
    const int turns = of_a.turns + step - of_b.turns;  // of b's root above a's
    const bool b_below = size_[of_a.root] >= size_[of_b.root];
    const std::size_t above = b_below ? of_a.root : of_b.root, below = b_below ? of_b.root : of_a.root;
    parent_[below] = above;
    turns_[below] = b_below ? turns : -turns;
    size_[above] += size_[below];
  }

  [[nodiscard]] std::size_t size_at(std::size_t root) const { return size_[root]; }

 private:
  std::vector<std::size_t> parent_, size_;
  std::vector<int> turns_;
};

struct Link {
  double cost;
  std::size_t from, to;
  int turns;  ///< of `to` above `from`
};

std::vector<Link> links_of(const Fringes& f) {
  std::vector<Link> out;
  const int w = f.phase_rad.width(), h = f.phase_rad.height();
  const auto add = [&](std::size_t a, std::size_t b) {
    if (f.usable[a] == 0 || f.usable[b] == 0) return;
    const double difference = f.phase_rad[b] - f.phase_rad[a];
    const double turns = std::round(difference / (2 * std::numbers::pi));
    const double step = std::abs(difference - 2 * std::numbers::pi * turns);
    if (step >= kMaxStep_rad) return;
    // Smooth and well modulated ones first.
    out.push_back({step + 0.5 * (f.relative[a] + f.relative[b]), a, b, -static_cast<int>(turns)});
  };
  for (int v = 0; v < h; ++v) {
    for (int u = 0; u < w; ++u) {
      const std::size_t here = f.phase_rad.index(u, v);
      if (u + 1 < w) add(here, here + 1);
      if (v + 1 < h) add(here, here + static_cast<std::size_t>(w));
    }
  }
  return out;
}

}  // namespace

Segments unwrap_segments(const Fringes& fringes) {
  std::vector<Link> links = links_of(fringes);
  std::ranges::sort(links, {}, &Link::cost);
  TurnForest forest(fringes.phase_rad.size());
  for (const Link& link : links) forest.join(link.from, link.to, link.turns);

  Segments out{fringes.phase_rad, {}};
  std::map<std::size_t, Pixels> by_root;
  for (std::size_t i = 0; i < out.phase_rad.size(); ++i) {
    const auto [root, turns] = forest.find(i);
    if (forest.size_at(root) < kMinSegment_px) continue;
    by_root[root].push_back(i);
    out.phase_rad[i] += 2 * std::numbers::pi * turns;
  }
  for (auto& [root, members] : by_root) out.members.push_back(std::move(members));
  return out;
}

}  // namespace enamel::test::plain
