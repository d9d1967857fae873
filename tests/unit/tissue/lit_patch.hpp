// Patches lit by a projector of a law of their own: reflectance by place, light that falls off and slants, contrast
// lost to light from inside, noise. No code of the pipeline's shades is used.
#pragma once

#include <cmath>
#include <functional>

#include "pipeline/tissue/shade_of.hpp"
#include "tests/unit/model/synthetic.hpp"

namespace enamel::tissue_test {

/// What a place returns: relative to white, and of the fringes' contrast on plaster.
struct Paint {
  double albedo = 0.8, contrast = 1;
};
using PaintAt = std::function<Paint(const Vec3d& p_model)>;

// Reflectances as the twin has them; contrast at a period of 1 mm with a fifth of the light from the surface.
inline constexpr Paint kPlaster{0.8, 1.0}, kEnamelPaint{0.60, 0.28}, kDentinePaint{0.42, 0.30}, kGumPaint{0.22, 0.41},
    kMetalPaint{0.10, 0.95};

struct Lamp {
  Vec3f projector_mm{-10, 0, 0};
  double contrast = 0.8;   ///< of fringes on plaster
  double dn_per_ms = 300;  ///< of white at 48 mm, facing
  double exposure_ms = 2;
  double veil_dn = 0;
  double noise = 0.02;    ///< of each pixel's light and modulation
  double blotches = 0.1;  ///< of the reflectance, from millimetre to millimetre
  std::uint64_t seed = 1;
};

inline pipeline::ShadeLight light_of(const Lamp& lamp) {
  return {lamp.projector_mm, static_cast<float>(lamp.contrast), static_cast<float>(lamp.veil_dn),
          static_cast<float>(lamp.exposure_ms)};
}

inline void paint(SurfacePatch& patch, const Pose& T_model_cam, const PaintAt& paint_at, const Lamp& lamp) {
  synthetic::Random random(lamp.seed);
  patch.texture_dn = Map<float>(patch.points.width(), patch.points.height(), 0.0F);
  patch.modulation_dn = patch.texture_dn;
  const double phase = 6.28 * random.uniform();
  for (std::size_t i = 0; i < patch.points.size(); ++i) {
    const Vec3f p = patch.points[i];
    if (!std::isfinite(p.x())) continue;
    const Vec3d at = T_model_cam * p.cast<double>();
    const Paint own = paint_at(at);
    const Vec3d to_light = (lamp.projector_mm - p).cast<double>();
    const double r2 = to_light.squaredNorm();
    const double facing = std::max(0.0, patch.normals[i].cast<double>().dot(to_light) / std::sqrt(r2));
    const double mottled = 1 + lamp.blotches * std::sin(4 * at.x() + phase) * std::sin(5 * at.y() + 2 * phase);
    const double light = lamp.dn_per_ms * lamp.exposure_ms * own.albedo * mottled * facing * 48 * 48 / r2;
    patch.texture_dn[i] = static_cast<float>(lamp.veil_dn + light * (1 + lamp.noise * random.normal()));
    patch.modulation_dn[i] =
        static_cast<float>(light * own.contrast * lamp.contrast * (1 + lamp.noise * random.normal()));
  }
}

}  // namespace enamel::tissue_test
