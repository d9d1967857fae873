// Why a pixel has no depth. Rejections are results, not errors: every pixel has exactly one.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace enamel::pipeline {

enum class PixelReject : std::uint8_t {
  kNone,        ///< measured
  kDark,        ///< no light: brightest frame below black + 5 sigma, or clipped at the converter's zero
  kSaturated,   ///< a phase frame above 0.97 full scale, and the other three do not make up for it
  kNoisy,       ///< predicted phase noise above the limit
  kRelative,    ///< unwrapped, but the code leaves more than one fringe order open
  kOutOfRange,  ///< outside the depth range or the projector's frame
  kEdge,        ///< beside a depth edge: the pixel sees both sides
  kSpeck,       ///< too small a region to trust
};
inline constexpr std::size_t kPixelRejects = 8;  ///< layout: number of them

inline constexpr std::array<std::string_view, kPixelRejects> kPixelRejectNames = {
    "valid", "dark", "saturated", "noisy", "undecided", "out_of_range", "edge", "speck"};

[[nodiscard]] constexpr std::string_view name_of(PixelReject r) noexcept {
  return kPixelRejectNames[static_cast<std::size_t>(r)];
}

}  // namespace enamel::pipeline
