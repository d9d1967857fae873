// Patterns as the flash of a DLPC347x holds them: block "PATN", little endian. Patterns vary along one axis only; one
// line of a pattern is stored as bit planes, the lowest bit first.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "calib/model/pattern.hpp"
#include "firmware/device/linux/projector/controller.hpp"
#include "protocol/base/result.hpp"

namespace enamel::fw {

/// The mirror arrays, with the unused mirrors that a line has before and behind the picture.
struct Dmd {
  std::string_view name;
  int width = 0;
  int height = 0;
  int before_rows = 0;
  int behind_columns = 0;
};
inline constexpr Dmd kDlp2010{"DLP2010", 854, 480, 32, 10};
inline constexpr Dmd kDlp3010{"DLP3010", 1280, 720, 48, 0};

/// One set of four patterns and the order table that shows it. Errors: kPatternSet when the rig's projector is not of
/// the mirror array's size, kConfigValue for bits outside 1…8.
[[nodiscard]] Result<std::vector<std::uint8_t>> pattern_block(const calib::Rig& rig, const Dmd& dmd,
                                                              const PatternTiming& timing, std::uint8_t leds);

}  // namespace enamel::fw
