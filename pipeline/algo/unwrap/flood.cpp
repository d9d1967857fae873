#include "pipeline/algo/unwrap/flood.hpp"

#include <algorithm>

#include "pipeline/algo/phase/poly_trig.hpp"

namespace enamel::algo {
namespace {

constexpr std::int32_t kNil = -1;

class Flooder {
 public:
  Flooder(const Map<float>& phase, const LinkMaps& links, FloodMaps& out)
      : phase_(phase), links_(links), out_(out), width_(static_cast<std::size_t>(phase.width())) {
    out_.work.next.resize(phase.size());
    out_.work.head.fill(kNil);
  }

  void grow(std::size_t seed, std::int32_t component) {
    label(seed, 0, component);
    while (top_ > 0) {
      std::int32_t& head = out_.work.head[static_cast<std::size_t>(top_)];
      if (head == kNil) {
        --top_;
        continue;
      }
      const auto i = static_cast<std::size_t>(head);
      head = out_.work.next[i];
      if (links_.east[i] != 0) reach(i, i + 1, component);  // never set in the last column
      if (i % width_ != 0 && links_.east[i - 1] != 0) reach(i, i - 1, component);
      if (links_.south[i] != 0) reach(i, i + width_, component);
      if (i >= width_ && links_.south[i - width_] != 0) reach(i, i - width_, component);
    }
  }

 private:
  void label(std::size_t i, int turn, std::int32_t component) {
    out_.turn[i] = static_cast<std::int16_t>(turn);
    out_.component[i] = component;
    const int q = links_.quality[i];
    std::int32_t& head = out_.work.head[static_cast<std::size_t>(q)];
    out_.work.next[i] = head;
    head = static_cast<std::int32_t>(i);
    top_ = std::max(top_, q);
  }

  void reach(std::size_t from, std::size_t to, std::int32_t component) {
    if (out_.component[to] != kNil) return;
    const float d = phase_[to] - phase_[from];
    label(to, out_.turn[from] + (d < -kPiF ? 1 : 0) - (d > kPiF ? 1 : 0), component);
  }

  const Map<float>& phase_;
  const LinkMaps& links_;
  FloodMaps& out_;
  std::size_t width_;
  int top_ = 0;
};

/// All valid pixels, best quality first, row order within a quality: a counting sort.
void sort_seeds(const Map<std::uint8_t>& quality, std::vector<std::int32_t>& seeds) {
  std::array<std::size_t, 257> start{};
  for (const std::uint8_t q : quality.pixels()) ++start[255U - q + 1U];
  for (std::size_t k = 1; k < start.size(); ++k) start[k] += start[k - 1];
  seeds.resize(quality.size());
  for (std::size_t i = 0; i < quality.size(); ++i) seeds[start[255U - quality[i]]++] = static_cast<std::int32_t>(i);
  seeds.resize(start[254]);  // quality 0 is invalid: its class, the last, is cut off
}

}  // namespace

void flood(const Map<float>& phase_rad, const LinkMaps& links, FloodMaps& out) {
  if (out.turn.width() != phase_rad.width() || out.turn.height() != phase_rad.height())
    out.turn = Map<std::int16_t>(phase_rad.width(), phase_rad.height());
  if (out.component.size() != phase_rad.size() || out.component.width() != phase_rad.width())
    out.component = Map<std::int32_t>(phase_rad.width(), phase_rad.height());
  std::fill(out.component.pixels().begin(), out.component.pixels().end(), kNil);
  sort_seeds(links.quality, out.work.seeds);
  Flooder flooder(phase_rad, links, out);
  out.components = 0;
  for (const std::int32_t seed : out.work.seeds) {
    if (out.component[static_cast<std::size_t>(seed)] == kNil)
      flooder.grow(static_cast<std::size_t>(seed), out.components++);
  }
}

}  // namespace enamel::algo
