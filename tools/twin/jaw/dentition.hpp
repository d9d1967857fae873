// Which teeth stand where: sizes by tooth, varied by seed, set along the arch.
#pragma once

#include <cstdint>
#include <vector>

#include "tools/twin/jaw/tooth.hpp"
#include "tools/twin/path/arch.hpp"

namespace enamel::twin {

enum class JawSide : std::uint8_t { kLower, kUpper };

/// Size, profiles and cusps of tooth 1 (central incisor) … 7 (second molar).
[[nodiscard]] ToothForm nominal_form(JawSide side, int number);

struct Dentition {
  ArchShape shape;
  std::vector<PlacedTooth> teeth;  ///< by arc length
};

/// Teeth 1…`last` of the right quadrant, and of the left when both_sides. The seed varies arch, sizes, cusps, rotations
/// and gaps.
struct OpenGap {
  int behind = 0;  ///< tooth of the right quadrant
  double mm = 0;   ///< wider than drawn by so much
};
[[nodiscard]] Dentition make_dentition(JawSide side, int last, bool both_sides, std::uint64_t seed, OpenGap open = {});

}  // namespace enamel::twin
