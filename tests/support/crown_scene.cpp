#include "tests/support/crown_scene.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/unit/decode/synthetic.hpp"

namespace enamel::test {
namespace {

/// Height, fringes (2 pi of phase): crowns of 3 fringes that roll off gently all round but for a flank that breaks off:
/// every crown hangs together with the gum bed, and with itself across the cliff only by the long way round.
double height_fringes(double x, double y) {
  double height = 0.25 * std::sin(3 * x + 1) + 0.15 * std::sin(5 * y);
  for (int k = 0; k < 2; ++k) {
    const double dx = (x - (0.5 + k)) / 0.44, dy = (y - 0.75) / 0.62;
    const double r = dx * dx + dy * dy;
    if (r >= 1) continue;
    const double dome = (3 + 0.3 * std::cos(9 * x) * std::cos(11 * y)) * (1 - r) * (1 - r);
    height += dx < -0.35 && std::abs(dy) < 0.6 ? 0.3 * dome : dome;  // a jump of up to 1.6 fringes
  }
  return height;
}

/// Light, 0 … 1: falls off to the border, a hard shadow beside each crown, darker gum, a weak wet spot.
double light(double x, double y, double height) {
  double l = 0.9 - 0.12 * ((x - 1) * (x - 1) + (y - 0.75) * (y - 0.75));
  for (int k = 0; k < 2; ++k)
    if (std::abs(x - (0.06 + k)) < 0.015 && std::abs(y - 0.75) < 0.3) l = 0;
  if (height < 0.6) l *= 0.75;
  if (std::hypot(x - 1.25, y - 0.8) < 0.06) l *= 0.2;
  return l;
}

}  // namespace

CrownBurst render_crowns(const CrownScene& s) {
  CrownBurst out{{s.width, s.height, {}},
                 Map<double>(s.width, s.height),
                 Map<float>(s.width, s.height),
                 Map<std::uint8_t>(s.width, s.height)};
  Normals normal(s.seed);
  for (int v = 0; v < s.height; ++v) {
    for (int u = 0; u < s.width; ++u) {
      const double x = 2.0 * u / s.width, y = 1.5 * v / s.height;
      const double carrier = 2 * std::numbers::pi * u / s.period_px, height = height_fringes(x, y);
      const double l = light(x, y, height), phi = carrier + 2 * std::numbers::pi * height;
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
