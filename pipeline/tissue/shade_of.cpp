#include "pipeline/tissue/shade_of.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace enamel::pipeline {
namespace {

constexpr float kReference_mm = 48;   // layout: a working distance; any would do
constexpr float kLeastCos = 0.5F;     // chosen: beyond 60 degrees an error of normals tells more than the surface
constexpr float kTranslucent = 0.5F;  // chosen: as of light from inside; teeth and gum show 0.2 to 0.45 of plaster's
constexpr int kHalfOctaves = 2;       // layout: step 1 stands for a quarter of a DN / ms

/// What a cell's measured pixels sum to.
struct CellSum {
  float light_dn = 0, fringe_dn = 0;
  Vec3f point = Vec3f::Zero(), normal = Vec3f::Zero();
  int count = 0;
};

CellSum sum_of(const SurfacePatch& patch, int i, int j) {
  CellSum sum;
  for (int v = j * kShadeCell_px; v < (j + 1) * kShadeCell_px; ++v) {
    for (int u = i * kShadeCell_px; u < (i + 1) * kShadeCell_px; ++u) {
      const std::size_t k = patch.points.index(u, v);
      if (!std::isfinite(patch.points[k].x()) || !std::isfinite(patch.normals[k].x())) continue;
      sum.light_dn += patch.texture_dn[k], sum.fringe_dn += patch.modulation_dn[k];
      sum.point += patch.points[k], sum.normal += patch.normals[k];
      ++sum.count;
    }
  }
  return sum;
}

std::uint8_t step_of(const CellSum& sum, const ShadeLight& light) {
  if (2 * sum.count < kShadeCell_px * kShadeCell_px) return kNoShade;
  const auto count = static_cast<float>(sum.count);
  const float own_dn = sum.light_dn / count - light.veil_dn;
  if (!(own_dn > 0) || !(sum.fringe_dn / count < kTranslucent * light.opaque_contrast * own_dn)) return kNoShade;
  const Vec3f to_light = light.projector_mm - sum.point / count;
  const float r2 = to_light.squaredNorm();
  const float cosine = sum.normal.dot(to_light) / std::sqrt(sum.normal.squaredNorm() * r2);
  if (!(cosine > kLeastCos)) return kNoShade;
  return shade_step(own_dn * r2 / (kReference_mm * kReference_mm) / (cosine * light.exposure_ms));
}

bool fits(const Map<float>& map, const SurfacePatch& patch) {
  return map.width() == patch.points.width() && map.height() == patch.points.height();
}

}  // namespace

/// By the exponent and comparisons alone: a library's logarithm may differ in its last bit.
std::uint8_t shade_step(float brightness) noexcept {
  if (!(brightness > 0) || !std::isfinite(brightness)) return kNoShade;
  int octave = 0;
  const float mantissa = std::frexp(brightness, &octave);  // 0.5 … 1
  constexpr double kStep = 1.0442737824274138;             // 2^(1/16)
  double edge = 0.5 * kStep;
  int within = 0;
  while (within < kShadeSteps - 1 && static_cast<double>(mantissa) >= edge) ++within, edge *= kStep;
  return static_cast<std::uint8_t>(std::clamp((octave - 1 + kHalfOctaves) * kShadeSteps + within + 1, 1, 255));
}

ShadeMap shade_of(const SurfacePatch& patch, const ShadeLight& light) {
  if (!fits(patch.texture_dn, patch) || !fits(patch.modulation_dn, patch) || patch.points.empty()) return {};
  if (!(light.exposure_ms > 0)) return {};
  ShadeMap out(patch.points.width() / kShadeCell_px, patch.points.height() / kShadeCell_px, kNoShade);
  for (int j = 0; j < out.height(); ++j) {
    for (int i = 0; i < out.width(); ++i) out(i, j) = step_of(sum_of(patch, i, j), light);
  }
  return out;
}

}  // namespace enamel::pipeline
