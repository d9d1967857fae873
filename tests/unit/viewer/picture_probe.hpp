// What a test can say of a picture without knowing it pixel by pixel.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "viewer/gl/picture.hpp"
#include "viewer/scene/colour.hpp"

namespace enamel::view::test {

using Rgb = std::array<int, 3>;

inline Rgb pixel(const Picture& p, int x, int y) {
  const std::size_t at =
      3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(p.width) + static_cast<std::size_t>(x));
  return {p.rgb[at], p.rgb[at + 1], p.rgb[at + 2]};
}

/// Warm and bright: tooth colour. The background is dark and bluish, panels are neutral.
inline bool is_tooth(const Rgb& c) {
  return c[0] > 110 && c[0] >= c[1] && c[1] > c[2] && c[0] - c[2] > 8 && c[0] - c[2] < 110;
}
inline bool is_green(const Rgb& c) { return c[1] > c[0] + 30 && c[1] > c[2] + 20; }

/// Soft tissue's red; teeth are warmer than they are red.
inline bool is_gum(const Rgb& c) { return c[0] > c[1] + 35 && c[0] > c[2] + 30 && c[0] < 235; }

struct Region {
  double x0, y0, x1, y1;  ///< shares of the picture
};
inline constexpr Region kMiddle{0.30, 0.12, 0.80, 0.95};       ///< clear of the panels and the outline
inline constexpr Region kLiveCorner{0.035, 0.69, 0.22, 0.91};  ///< inside the live image (4:3, 1280 x 800)

template <class Predicate>
double share_of(const Picture& p, const Region& r, Predicate&& yes) {
  std::size_t hits = 0;
  std::size_t all = 0;
  for (int y = static_cast<int>(r.y0 * p.height); y < static_cast<int>(r.y1 * p.height); ++y) {
    for (int x = static_cast<int>(r.x0 * p.width); x < static_cast<int>(r.x1 * p.width); ++x) {
      hits += yes(pixel(p, x, y)) ? 1U : 0U;
      ++all;
    }
  }
  return static_cast<double>(hits) / static_cast<double>(all);
}

inline double mean_level(const Picture& p, const Region& r) {
  double sum = 0;
  share_of(p, r, [&sum](const Rgb& c) {
    sum += c[1];
    return false;
  });
  return sum / ((static_cast<int>(r.x1 * p.width) - static_cast<int>(r.x0 * p.width)) *
                static_cast<double>(static_cast<int>(r.y1 * p.height) - static_cast<int>(r.y0 * p.height)));
}

/// The outline's colour at the left edge's middle, compared in 8-bit levels.
inline double outline_distance(const Picture& p, const Colour& wanted) {
  const Rgb c = pixel(p, 1, p.height / 2);
  const auto off = [](int have, float want) { return std::abs(have - 255.0 * static_cast<double>(want)); };
  return off(c[0], wanted.r) + off(c[1], wanted.g) + off(c[2], wanted.b);
}

}  // namespace enamel::view::test
