// Colours of the viewer, sRGB 0…1.
#pragma once

#include <array>

namespace enamel::view {

struct Colour {
  float r = 0, g = 0, b = 0;
  friend constexpr bool operator==(const Colour&, const Colour&) = default;
};

/// Warm ivory of the model; matte grey of the mono view.
inline constexpr Colour kTooth{0.945F, 0.892F, 0.800F};
inline constexpr Colour kMonoGrey{0.72F, 0.73F, 0.75F};
/// Surface whose place in the model nobody knows yet: cold, so that it is never taken for the model.
inline constexpr Colour kApartTooth{0.60F, 0.76F, 0.93F};

/// Gum, tongue and cheek; always striped, too.
inline constexpr Colour kSoftTone{0.84F, 0.52F, 0.50F};

/// State colours; each is always shown together with words.
inline constexpr Colour kGood{0.22F, 0.80F, 0.47F};
inline constexpr Colour kWeak{0.98F, 0.70F, 0.16F};
inline constexpr Colour kBad{0.94F, 0.27F, 0.29F};
inline constexpr Colour kIdle{0.55F, 0.61F, 0.69F};
inline constexpr Colour kViolet{0.48F, 0.45F, 0.98F};
inline constexpr Colour kAccent{0.36F, 0.74F, 0.98F};

/// Quality ramp, safe for colour-blind eyes: 0 orange (scan again), 0.5 white, 1 blue (well covered). Values are
/// clamped; NaN reads as 0.
inline constexpr std::array<Colour, 3> kQualityRamp{Colour{0.90F, 0.45F, 0.05F}, Colour{0.96F, 0.95F, 0.93F},
                                                    Colour{0.10F, 0.40F, 0.78F}};
[[nodiscard]] Colour quality_colour(float quality) noexcept;

/// Relative luminance of WCAG 2.1 and the contrast ratio 1…21 of two colours.
[[nodiscard]] double luminance(const Colour& c) noexcept;
[[nodiscard]] double contrast_ratio(const Colour& a, const Colour& b) noexcept;

}  // namespace enamel::view
