#include "tools/twin/render/body_light.hpp"

#include <algorithm>
#include <cmath>

#include "tools/twin/render/facet_mirror.hpp"

namespace enamel::twin {
namespace {

constexpr double kWater = 1.33;          // saliva: 99 % water
constexpr double kApertureAlpha = 0.02;  // both lenses' openings, 2 degrees: no mirror image is a point
constexpr double kGrazing = 0.05;        // cosine below which a film is not looked through

/// Pattern coordinate as a linear function of place about the point hit: of its few tenths of a mm the projection's
/// curvature makes less than 1e-3 px.
struct Ruler {
  double middle = 0;
  Vec3d gradient = Vec3d::Zero();  // px / mm, model directions

  Ruler(const Instrument& instrument, const View& view, const Struck& struck, const Lane& lane) {
    const bool v = instrument.light.axis_v();
    const auto& lens = instrument.rig.projector;
    const Vec3d& p = struck.in_projector;
    const double scale = (v ? lens.fy : lens.fx) / p.z();
    const Vec3d g = v ? Vec3d(0, scale, -scale * p.y() / p.z()) : Vec3d(scale, 0, -scale * p.x() / p.z());
    gradient = view.R_model_cam * (view.R_proj_cam.transpose() * g);
    middle = v ? lane.v : lane.u;
  }
  /// At an offset from the point hit.
  [[nodiscard]] double at(const Vec3d& offset) const { return middle + gradient.dot(offset); }
  /// Pixels a mm along a plane, in the direction where they are most.
  [[nodiscard]] double along2(const Vec3d& normal) const {
    const double across = gradient.dot(normal);
    return gradient.squaredNorm() - across * across;
  }
};

/// What the solid surface is lit and seen by, through the film if there is one. Offsets from the point hit, mm.
struct Ways {
  Vec3d seen = Vec3d::Zero();   // the point that is seen
  Vec3d entry = Vec3d::Zero();  // where its light passed the upper side of the film
  Vec3d to_light, to_camera;    // in the film
  double index = 1;             // of what lies on the surface
  double pass = 1;              // share of the light that the film lets through, both ways
};

void add(Lane& lane, double coordinate, double weight, double sigma2) {
  if (weight <= 0 || lane.parts == kMaxParts) return;
  lane.part[lane.parts++] = {coordinate, static_cast<float>(weight), static_cast<float>(sigma2)};
}

double widened(double roughness) { return std::sqrt(roughness * roughness + kApertureAlpha * kApertureAlpha); }

/// Bends both ways at the film's upper side and adds its glare. The upper side is a plane over the point hit; the solid
/// surface is its facet's plane. Without a usable film the ways stay straight.
void pass_film(const Ruler& ruler, const Struck& struck, const Look& look, Ways& ways, Lane& lane) {
  const RayScene::Surfel& s = look.surfel;
  const double h = static_cast<double>(s.film_mm), level = static_cast<double>(s.level);
  const Vec3d upper = ((1.0 - level) * s.normal + level * Vec3d::UnitZ()).normalized();
  const double facing = upper.dot(ways.to_camera);
  if (h <= 0 || facing < kGrazing || upper.dot(ways.to_light) < kGrazing) return;
  const auto seen_along = refract(ways.to_camera, upper, 1.0 / kWater);
  const auto lit_along = refract(ways.to_light, upper, 1.0 / kWater);
  if (!seen_along || !lit_along || -seen_along->dot(s.facet) < kGrazing) return;
  const Vec3d in = ways.to_camera * (h / facing);  // where the camera's ray meets the liquid
  constexpr double kFilmMirror = mirror_of_index(kWater);
  const double glare =
      facet_mirror(upper, ways.to_light, ways.to_camera, widened(look.film_roughness), kFilmMirror) * struck.strength;
  add(lane, ruler.at(in), glare, lane.sigma2);
  ways.seen = in + *seen_along * (-in.dot(s.facet) / seen_along->dot(s.facet));
  // Back along the light to the upper side. Its direction outside changes by 1/48 a mm: h^2 / 48 = 2 um at 0.3 mm.
  ways.entry = ways.seen + *lit_along * ((h - ways.seen.dot(upper)) / lit_along->dot(upper));
  ways.pass = (1.0 - schlick(kFilmMirror, facing)) * (1.0 - schlick(kFilmMirror, upper.dot(ways.to_light)));
  ways.to_camera = -*seen_along;
  ways.to_light = -*lit_along;
  ways.index = kWater;
}

/// Shift along the surface from where light enters to below where it is seen, for a reach of 1 mm. Light keeps its
/// direction for a way, not for a depth: what comes in or leaves at a slant is displaced by the reach times the sine
/// inside, which Snell makes the part along the surface over the index. Photons: tests/unit/twin/slant_photons.hpp.
Vec3d entry_shift(const Ways& ways, const Vec3d& normal, double index) {
  const Vec3d apart = ways.to_light - ways.to_camera;
  return ways.index / index * (apart - apart.dot(normal) * normal);
}

}  // namespace

void split_light(const Instrument& instrument, const View& view, const Struck& struck, const Look& look, Lane& lane) {
  const RayScene::Surfel& s = look.surfel;
  const Material& m = look.material;
  const Ruler ruler(instrument, view, struck, lane);
  const double diffuse = lane.weight;
  const double white = struck.strength;
  lane.weight = 0;
  Ways ways;
  ways.to_light = struck.to_light;
  ways.to_camera = -struck.from_camera.normalized();
  pass_film(ruler, struck, look, ways, lane);
  add(lane, ruler.at(ways.entry),
      ways.pass * white *
          facet_mirror(s.normal, ways.to_light, ways.to_camera, widened(m.roughness), m.mirror(ways.index)),
      lane.sigma2);
  const double surface = m.lobes.empty() ? 1.0 : m.surface_share;
  add(lane, ruler.at(ways.entry), ways.pass * surface * diffuse, lane.sigma2);
  double sum = 0;
  for (const Lobe& lobe : m.lobes) sum += lobe.weight;
  if (sum <= 0) return;
  const double along2 = ruler.along2(s.normal);
  const Vec3d shift = entry_shift(ways, s.normal, m.index);
  for (const Lobe& lobe : m.lobes) {
    add(lane, ruler.at(ways.entry + lobe.depth_mm * shift), ways.pass * (1.0 - surface) * diffuse * lobe.weight / sum,
        lane.sigma2 + lobe.sigma_mm * lobe.sigma_mm * along2);
  }
}

}  // namespace enamel::twin
