// How bright a surface is by itself, in cells of a burst's image: what tells teeth from gum, tongue and cheek. Light is
// taken as a ratio, in steps of a sixteenth of an octave, so that one byte a cell tells it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "pipeline/types/map.hpp"

namespace enamel {

inline constexpr int kShadeCell_px = 8;          ///< chosen: a third of a millimetre on the object
inline constexpr std::uint8_t kNoShade = 0;      ///< not measured, too steep, or as opaque as plaster
inline constexpr int kShadeSteps = 16;           ///< layout: an octave of brightness
inline constexpr std::uint8_t kNothingSoft = 0;  ///< a limit below which no shade lies

/// Cells of an image: kNoShade, or brightness in steps. Empty where light does not go into the surface.
using ShadeMap = Map<std::uint8_t>;

/// The shade at a pixel; kNoShade outside, and of an empty map.
[[nodiscard]] inline std::uint8_t shade_at(const ShadeMap& shade, int u_px, int v_px) noexcept {
  const int i = u_px / kShadeCell_px, j = v_px / kShadeCell_px;
  return shade.contains(i, j) ? shade(i, j) : kNoShade;
}

/// Whether a shade is that of soft tissue: darker than the limit between it and teeth, kNothingSoft while there is
/// none.
[[nodiscard]] constexpr bool is_soft(std::uint8_t shade, std::uint8_t soft_below) noexcept {
  return shade != kNoShade && shade < soft_below;
}

}  // namespace enamel
