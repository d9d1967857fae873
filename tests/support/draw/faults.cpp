#include "tests/support/draw/faults.hpp"

#include <fmt/format.h>

#include <utility>

#include "tests/support/draw/random.hpp"

namespace enamel::test {
namespace {

constexpr std::uint64_t kOfFaults = 64;  ///< the stream of a seed's faults
constexpr double kBurstInterval_s = 1.0 / 30;

/// Frame k alone, taken otherwise.
std::vector<std::uint8_t> retaken(const Drawn& drawn, std::size_t k, Shot shot) {
  shot.taken = {};
  shot.taken[k] = true;
  shot.with_truth = false;
  shot.noise = 1;
  return std::move(render(drawn, shot).frames.frames[k]);
}

}  // namespace

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
    case FrameFault::kPermuted:
      std::swap(out.frames.frames[k], out.frames.frames[other]);
      out.what += fmt::format(" and frame {}", other);
      break;
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
