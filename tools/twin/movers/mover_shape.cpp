#include "tools/twin/movers/mover_shape.hpp"

#include <cmath>

#include "tools/twin/surface/noise.hpp"

namespace enamel::twin {
namespace {

/// Waves of relief or albedo: noise of that amplitude, over patches of that size.
struct Grain {
  double amplitude = 0;
  Vec3d size_mm = Vec3d::Ones();
  [[nodiscard]] double at(const Vec3d& p, std::uint64_t seed) const {
    return amplitude == 0 ? 0.0 : amplitude * value_noise(p.cwiseQuotient(size_mm), seed);
  }
};

constexpr double kMucosaAlbedo = 0.22;  // as the gum's of default_materials()

struct Look {
  MoverForm form;
  double power = 2;    ///< of the superellipse along x: 2 an ellipsoid, large: a cylinder
  Grain coarse, fine;  ///< mm
  Grain mottle;        ///< relative albedo
  double albedo = 0.5;
};

Look look_of(MoverKind kind) {
  switch (kind) {
    case MoverKind::kTongue:  // papillae on gentle waves
      return {{{15, 9, 6}, true}, 2.2, {0.25, {3, 3, 3}}, {0.05, {0.4, 0.4, 0.4}}, {0.15, {0.8, 0.8, 0.8}}, 0.45};
    case MoverKind::kCheek:  // folds along
      return {{{18, 5, 11}, true}, 3.0, {0.6, {12, 3, 3}}, {0.03, {0.6, 0.6, 0.6}}, {0.12, {2, 2, 2}}, 0.5};
    case MoverKind::kFinger:  // glove: smooth, with shallow creases across
      return {{{22, 7, 7}, false}, 4.0, {0.08, {1.5, 4, 4}}, {}, {0.03, {3, 3, 3}}, 0.65};
    case MoverKind::kCotton:  // fibres along
      return {{{16, 4.5, 4.5}, false}, 8.0, {0.2, {4, 2, 2}}, {0.08, {1.5, 0.3, 0.3}}, {0.06, {1, 0.3, 0.3}}, 0.85};
  }
  return {};
}

/// Direction on the unit sphere to the superellipsoid of revolution |x|^p + (y² + z²)^(p/2) = 1.
Vec3d on_form(const Vec3d& d, double power) {
  const double round = std::hypot(d.y(), d.z());
  return d * std::pow(std::pow(std::abs(d.x()), power) + std::pow(round, power), -1.0 / power);
}

/// A tongue arches and thickens, a cheek bulges; both keep about their volume.
Vec3d bent(const Vec3d& p, const MoverForm& form, const Bend& bend) {
  if (!form.soft) return p;
  constexpr double kThicken = 0.12, kArch = 0.2;  // of the half axes
  const double x = p.x() / form.half.x(), y = p.y() / form.half.y(), thick = 1 + kThicken * bend.across;
  return {p.x(), p.y() / thick + kArch * form.half.y() * bend.along * x,
          p.z() * thick + kArch * form.half.z() * (bend.across * (1 - x * x) + bend.along * x * y)};
}

}  // namespace

MoverForm mover_form(MoverKind kind) { return look_of(kind).form; }

TriSurface mover_mesh(const MoverConfig& config, const Bend& bend, std::uint64_t seed) {
  const Look look = look_of(config.kind);
  const bool mucosa = config.mucosa && look.form.soft;
  const double own = mucosa ? kMucosaAlbedo : look.albedo;
  const double albedo = config.albedo > 0 ? config.albedo : own;
  constexpr double kEdge = 0.0125;  // of the unit sphere's mesh: 0.2 mm on a body of 15 mm
  TriSurface out = tessellate(Ball{}, kEdge);
  for (std::size_t i = 0; i < out.vertices.size(); ++i) {
    const Vec3d unit = on_form(out.vertices[i].cast<double>(), look.power);
    const Vec3d p = unit.cwiseProduct(look.form.half);
    const Vec3d outwards = unit.cwiseQuotient(look.form.half).normalized();
    const double relief = look.coarse.at(p, seed) + look.fine.at(p, seed ^ 1U);
    out.vertices[i] = bent(p + relief * outwards, look.form, bend).cast<float>();
    out.albedo[i] = static_cast<float>(albedo * (1 + look.mottle.at(p, seed ^ 2U)));
  }
  if (mucosa) out.material.assign(out.vertices.size(), static_cast<std::uint8_t>(MaterialId::kGum));
  compute_normals(out);
  return out;
}

}  // namespace enamel::twin
