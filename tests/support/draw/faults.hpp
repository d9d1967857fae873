// Drawn bursts with a frame that does not belong: what probes, cables and drivers do to them.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "tests/support/draw/render.hpp"

namespace enamel::test {

enum class FrameFault : std::uint8_t {
  kStale,     ///< a frame of the same scene a thirtieth of a second earlier
  kRepeated,  ///< a frame in the place of another one, too
  kPermuted,  ///< the frames in any other order that no other surface shows
  kForeign,   ///< a frame of another scene
  kDarker,    ///< a frame exposed for 0.5 to 0.95 of the time
  kBrighter,  ///< 1.05 to 1.6 of it
};
inline constexpr std::size_t kFrameFaults = 6;
inline constexpr std::array<std::string_view, kFrameFaults> kFrameFaultNames = {"stale",   "repeated", "permuted",
                                                                                "foreign", "darker",   "brighter"};

/// Which frame comes in the place of each.
using FrameOrder = std::array<std::size_t, 4>;
[[nodiscard]] FrameSet in_order(const FrameSet& frames, const FrameOrder& order);

struct FaultedBurst {
  FrameSet frames;
  std::string what;  ///< which frame, and by which, for an engineer
};

/// clean: the frames of render(drawn). seed: draws which frame it is, and by how much.
[[nodiscard]] FaultedBurst faulted(const Drawn& drawn, const FrameSet& clean, FrameFault fault, std::uint64_t seed);

}  // namespace enamel::test
