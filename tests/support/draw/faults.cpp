#include "tests/support/draw/faults.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <utility>

#include "tests/support/draw/random.hpp"

namespace enamel::test {
namespace {

constexpr std::uint64_t kOfFaults = 64;  ///< the stream of a seed's faults
constexpr double kBurstInterval_s = 1.0 / 30;

/// Whether a surface elsewhere shows the same frames in order: mode M's phase frames 0, 2, 3 moved on by a third of a
/// fringe, which codes of some ratios cannot tell (pipeline/decode/mode_m).
bool may_be_another_surface(calib::PatternMode mode, const FrameOrder& order) {
  return mode == calib::PatternMode::kMicro && (order == FrameOrder{2, 1, 3, 0} || order == FrameOrder{3, 1, 0, 2});
}

FrameOrder wrong_order(calib::PatternMode mode, Random& r) {
  constexpr FrameOrder kRight{0, 1, 2, 3};
  FrameOrder order = kRight;
  do {
    for (std::size_t k = 3; k > 0; --k)
      std::swap(order[k], order[static_cast<std::size_t>(r.whole(0, static_cast<int>(k)))]);
  } while (order == kRight || may_be_another_surface(mode, order));
  return order;
}

/// Frame k alone, taken otherwise.
std::vector<std::uint8_t> retaken(const Drawn& drawn, std::size_t k, Shot shot) {
  shot.taken = {};
  shot.taken[k] = true;
  shot.with_truth = false;
  shot.noise = 1;
  return std::move(render(drawn, shot).frames.frames[k]);
}

}  // namespace

FrameSet in_order(const FrameSet& frames, const FrameOrder& order) {
  FrameSet out = frames;
  for (std::size_t k = 0; k < order.size(); ++k) out.frames[k] = frames.frames[order[k]];
  return out;
}

FaultedBurst faulted(const Drawn& drawn, const FrameSet& clean, FrameFault fault, std::uint64_t seed) {
  Random r(seed, kOfFaults + static_cast<std::uint64_t>(fault));
  const auto k = static_cast<std::size_t>(r.whole(0, 3));
  const std::size_t other = (k + static_cast<std::size_t>(r.whole(1, 3))) % 4;
  FaultedBurst out{clean, fmt::format("frame {}", k)};
  Shot shot;
  switch (fault) {
    case FrameFault::kStale:
      shot.later_s = -kBurstInterval_s;
      out.frames.frames[k] = retaken(drawn, k, shot);
      break;
    case FrameFault::kRepeated:
      out.frames.frames[k] = clean.frames[other];
      out.what += fmt::format(" is frame {}", other);
      break;
    case FrameFault::kPermuted: {
      const FrameOrder order = wrong_order(drawn.rig.patterns.mode, r);
      out.frames = in_order(clean, order);
      out.what = fmt::format("frames {}", fmt::join(order, " "));
      break;
    }
    case FrameFault::kForeign:
      out.frames.frames[k] = retaken(before_other_scene(drawn, seed + 1'000'003), k, shot);
      break;
    case FrameFault::kDarker:
    case FrameFault::kBrighter:
      shot.gain[k] = fault == FrameFault::kDarker ? r(0.5, 0.95) : r(1.05, 1.6);
      out.frames.frames[k] = retaken(drawn, k, shot);
      out.what += fmt::format(" times {:.2f}", shot.gain[k]);
      break;
  }
  return out;
}

}  // namespace enamel::test
