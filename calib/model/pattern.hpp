// The pattern set that a rig states, written out: what the twin projects, what is loaded into a projector, and the code
// that the decoder looks for are this one definition.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "calib/model/rig.hpp"

namespace enamel::calib {

/// As rig.json says it: plain4, T, single, M, multi.
[[nodiscard]] std::string_view name_of(PatternMode mode) noexcept;
[[nodiscard]] inline std::string_view mode_name(const PatternValues& patterns) noexcept {
  return name_of(patterns.mode);
}

/// The four frames of a burst, as a probe shows when it scans; false for the sets of a calibration (mode multi), of
/// which the rig states no pattern.
[[nodiscard]] bool is_burst_set(const PatternValues& patterns) noexcept;

/// +1 or -1 of frame 3 in half fringe `cell`, which covers phase [cell pi, (cell + 1) pi) from projector pixel 0.
/// +1 everywhere in modes without polarity.
[[nodiscard]] int polarity_of_cell(const PatternValues& patterns, long cell) noexcept;

/// Emission wanted of projector pixel `i` along the pattern axis in frame `frame` 0…3: 0…255, linear, before rounding.
/// Needs is_burst_set().
[[nodiscard]] double pattern_level(const PatternValues& patterns, int frame, int i);

/// Four frames, one value a projector pixel along the pattern axis; all lines across it are alike.
template <class Level>
struct PatternFrames {
  bool axis_v = false;  ///< values run along projector v instead of u
  std::array<std::vector<Level>, 4> frames;
};
using PatternLevels = PatternFrames<double>;
using PatternTable = PatternFrames<std::uint8_t>;

/// Levels to command, 0…255 before rounding: through the inverse of the rig's response where it states one, so that the
/// emission becomes that of pattern_level(). Needs is_burst_set().
[[nodiscard]] PatternLevels pattern_levels(const Rig& rig);

/// The same as a projector takes it: rounded to 8 bits.
[[nodiscard]] PatternTable pattern_table(const Rig& rig);

}  // namespace enamel::calib
