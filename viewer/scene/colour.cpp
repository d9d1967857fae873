#include "viewer/scene/colour.hpp"

#include <algorithm>
#include <cmath>

namespace enamel::view {

Colour quality_colour(float quality) noexcept {
  const float q = quality >= 0 ? std::min(quality, 1.0F) : 0.0F;  // NaN compares false
  const bool upper = q > 0.5F;
  const Colour& a = upper ? kQualityRamp[1] : kQualityRamp[0];
  const Colour& b = upper ? kQualityRamp[2] : kQualityRamp[1];
  const float t = upper ? 2 * q - 1 : 2 * q;
  return {a.r + t * (b.r - a.r), a.g + t * (b.g - a.g), a.b + t * (b.b - a.b)};
}

double luminance(const Colour& c) noexcept {
  const auto linear = [](float v) {
    const double s = static_cast<double>(v);
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
  };
  return 0.2126 * linear(c.r) + 0.7152 * linear(c.g) + 0.0722 * linear(c.b);
}

double contrast_ratio(const Colour& a, const Colour& b) noexcept {
  const double la = luminance(a);
  const double lb = luminance(b);
  return (std::max(la, lb) + 0.05) / (std::min(la, lb) + 0.05);
}

}  // namespace enamel::view
