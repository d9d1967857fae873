#include "tests/support/crown_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tests/unit/decode/synthetic.hpp"

namespace enamel::test {
namespace {

struct Crown {
  double x = 0.5, y = 0.75, half_width = 0.44, half_height = 0.62, height = 3;
  double cliff = -0.35, cliff_half_height = 0.6, kept = 0.3;  ///< the flank left of `cliff` keeps this share of height
  double shadow_x = 0.06, shadow_half_width = 0.015, shadow_half_height = 0.3;
};

struct Layout {
  std::array<Crown, 2> crowns;
  double gum = 0.75, spot_x = 1.25, spot_y = 0.8, spot_radius = 0.06, spot_light = 0.2;
};

/// Uniform draws about the fixed scene's values; every crown still hangs together with the gum bed the long way round.
Layout draw_layout(std::uint64_t number) {
  Layout out;
  out.crowns[1].x += 1, out.crowns[1].shadow_x += 1;
  if (number == 0) return out;
  std::uint64_t state = number;
  const auto draw = [&](double low, double high) {
    state += 0x9E3779B97F4A7C15U;  // SplitMix64
    std::uint64_t z = (state ^ (state >> 30U)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
    return low + (high - low) * static_cast<double>((z ^ (z >> 31U)) >> 11U) / 9007199254740992.0;
  };
  for (std::size_t k = 0; k < 2; ++k) {
    Crown& c = out.crowns[k];
    c.half_width = draw(0.36, 0.46), c.half_height = draw(0.5, 0.66), c.height = draw(1.5, 4);
    c.x = static_cast<double>(k) + draw(0.47, 0.53), c.y = draw(0.7, 0.8);
    c.cliff = draw(-0.6, -0.1), c.cliff_half_height = draw(0.3, 0.7), c.kept = draw(0, 0.6);
    c.shadow_x = static_cast<double>(k) + draw(0.03, 0.2), c.shadow_half_width = draw(0.005, 0.03);
    c.shadow_half_height = draw(0.1, 0.4);
  }
  out.gum = draw(0.6, 0.9);
  out.spot_x = draw(0.2, 1.8), out.spot_y = draw(0.2, 1.3), out.spot_radius = draw(0.03, 0.1);
  out.spot_light = draw(0.1, 0.5);
  return out;
}

/// Height, fringes (2 pi of phase): crowns of some fringes that roll off gently all round but for a flank that breaks
/// off: every crown hangs together with the gum bed, and with itself across the cliff only by the long way round.
double height_fringes(const Layout& layout, double x, double y) {
  double height = 0.25 * std::sin(3 * x + 1) + 0.15 * std::sin(5 * y);
  for (const Crown& c : layout.crowns) {
    const double dx = (x - c.x) / c.half_width, dy = (y - c.y) / c.half_height;
    const double r = dx * dx + dy * dy;
    if (r >= 1) continue;
    const double dome = (c.height + 0.3 * std::cos(9 * x) * std::cos(11 * y)) * (1 - r) * (1 - r);
    height += dx < c.cliff && std::abs(dy) < c.cliff_half_height ? c.kept * dome : dome;  // 0: up to 1.6 fringes
  }
  return height;
}

/// Light, 0 … 1: falls off to the border, a hard shadow beside each crown, darker gum, a weak wet spot.
double light(const Layout& layout, double x, double y, double height) {
  double l = 0.9 - 0.12 * ((x - 1) * (x - 1) + (y - 0.75) * (y - 0.75));
  for (const Crown& c : layout.crowns)
    if (std::abs(x - c.shadow_x) < c.shadow_half_width && std::abs(y - 0.75) < c.shadow_half_height) l = 0;
  if (height < 0.6) l *= layout.gum;
  if (std::hypot(x - layout.spot_x, y - layout.spot_y) < layout.spot_radius) l *= layout.spot_light;
  return l;
}

}  // namespace

CrownBurst render_crowns(const CrownScene& s) {
  CrownBurst out{{s.width, s.height, {}},
                 Map<double>(s.width, s.height),
                 Map<float>(s.width, s.height),
                 Map<std::uint8_t>(s.width, s.height)};
  Normals normal(s.seed);
  const Layout layout = draw_layout(s.layout);
  for (int v = 0; v < s.height; ++v) {
    for (int u = 0; u < s.width; ++u) {
      const double x = 2.0 * u / s.width, y = 1.5 * v / s.height;
      const double carrier = 2 * std::numbers::pi * u / s.period_px, height = height_fringes(layout, x, y);
      const double l = light(layout, x, y, height), phi = carrier + 2 * std::numbers::pi * height;
      out.phase_rad(u, v) = phi;
      out.carrier_rad(u, v) = static_cast<float>(carrier);
      out.lit(u, v) = l > 0 ? 1 : 0;
      for (std::size_t k = 0; k < 4; ++k) {
        const double dn =
            8 + l * (100 + 78 * std::cos(phi + static_cast<double>(k) * std::numbers::pi / 2)) + s.noise_dn * normal();
        out.frames.frames[k].push_back(static_cast<std::uint8_t>(std::clamp(std::lround(dn), 0L, 255L)));
      }
    }
  }
  return out;
}

}  // namespace enamel::test
