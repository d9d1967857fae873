#include "tools/twin/render/light_tracer.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "tools/twin/render/body_light.hpp"

namespace enamel::twin {
namespace {

constexpr double kNearMm = 5, kFarMm = 250;  // camera z within which anything is seen
constexpr double kShadowOffsetMm = 2e-3;     // keeps a shadow ray off its own facet

void set_lane(RayPacket& rays, std::size_t i, const Vec3d& origin, const Vec3d& direction, double near, double far) {
  rays.ox[i] = static_cast<float>(origin.x());
  rays.oy[i] = static_cast<float>(origin.y());
  rays.oz[i] = static_cast<float>(origin.z());
  rays.dx[i] = static_cast<float>(direction.x());
  rays.dy[i] = static_cast<float>(direction.y());
  rays.dz[i] = static_cast<float>(direction.z());
  rays.near[i] = static_cast<float>(near);
  rays.far[i] = static_cast<float>(far);
  rays.active[i] = -1;
}

void darken(Lane& lane) {
  lane.lit = false;
  lane.weight = 0;
  lane.parts = 0;
}

}  // namespace

std::vector<double> ray_table(const Lens& lens, int width, int height, const std::vector<double>& dx,
                              const std::vector<double>& dy) {
  const std::size_t w = static_cast<std::size_t>(width), samples = dx.size();
  std::vector<double> table(w * static_cast<std::size_t>(height) * samples * 2);
  tbb::parallel_for(0, height, [&](int y) {
    double* out = table.data() + static_cast<std::size_t>(y) * samples * w * 2;
    for (std::size_t s = 0; s < samples; ++s) {
      for (int x = 0; x < width; ++x, out += 2) {
        const Eigen::Vector2d d = lens.direction(x + dx[s], y + dy[s]);
        out[0] = d.x();
        out[1] = d.y();
      }
    }
  });
  return table;
}

View::View(const Instrument& instrument, const Pose& T_model_cam)
    : R_model_cam(T_model_cam.linear()),
      R_proj_cam(instrument.T_proj_cam.linear()),
      camera(T_model_cam.translation()),
      projector(T_model_cam * instrument.T_proj_cam.inverse().translation()),
      t_proj_cam(instrument.T_proj_cam.translation()) {}

LightTracer::LightTracer(const Instrument& instrument, const RayScene& scene, const LightConfig& light)
    : instrument_(instrument), scene_(scene), light_(light) {
  constexpr double kReferenceAlbedo = 0.8;
  const auto& m = scene.surroundings().materials;
  has_materials_ = !scene.surroundings().mesh.film.empty() ||
                   std::any_of(m.begin(), m.end(), [](const Material& each) { return !each.is_plain(); });
  gain_ = light.reference_fraction / kReferenceAlbedo * (light.falloff ? light.reference_mm * light.reference_mm : 1.0);
}

void LightTracer::light(const View& view, const Vec3d& ray_cam, const RayScene::Surfel& s, Lane& lane) const {
  lane.hit = true;
  lane.z = s.t;
  lane.ambient = light_.ambient * static_cast<double>(s.albedo);
  const Vec3d p = view.R_proj_cam * (s.t * ray_cam) + view.t_proj_cam;
  lane.albedo = s.albedo;
  lane.in_projector = instrument_.projector.project(p.x(), p.y(), p.z(), lane.u, lane.v) &&
                      instrument_.projector.in_frame(lane.u, lane.v);
  if (!lane.in_projector) return;
  lane.sigma2 = instrument_.light.sigma2_at(p.z());
  const Vec3d to_light = view.projector - (view.camera + view.R_model_cam * (s.t * ray_cam));
  const double r2 = to_light.squaredNorm(), r = std::sqrt(r2);
  const double cosine = s.normal.dot(to_light) / r;
  lane.faces = lane.lit = s.facet.dot(to_light) > 0;
  if (!lane.lit || cosine <= 0) return;
  lane.weight = gain_ * static_cast<double>(s.albedo) * cosine;
  double fall = 1;
  if (light_.falloff) {
    const double cp2 = p.z() * p.z() / r2;
    const double cc2 = 1.0 / ray_cam.squaredNorm();
    fall = cp2 * cp2 * cc2 * cc2 / r2;
    lane.weight *= fall;
    lane.ambient *= cc2 * cc2;
  }
  if (!has_materials_) return;
  const Material& material = scene_.surroundings().materials[s.material];
  if (material.is_plain() && s.film_mm <= 0) return;
  const Struck struck{s.t * (view.R_model_cam * ray_cam), p, to_light / r, gain_ * fall};
  split_light(instrument_, view, struck, {s, material, scene_.surroundings().film_roughness}, lane);
}

void LightTracer::trace(const View& view, const double* directions, std::size_t n, const Shade* known,
                        Lanes8& lanes) const {
  RayPacket rays;
  HitPacket hits;
  std::array<Vec3d, kPacket> ray_cam, ray_model;
  for (std::size_t i = 0; i < n; ++i) {
    const double* d = directions + 2 * i;
    ray_cam[i] = Vec3d(d[0], d[1], 1.0);
    ray_model[i] = view.R_model_cam * ray_cam[i];
    set_lane(rays, i, view.camera, ray_model[i], kNearMm, kFarMm);
  }
  const SceneAt scene(scene_, view.guests);
  scene.intersect(rays, hits);
  RayPacket shadows;
  bool any = false;
  for (std::size_t i = 0; i < n; ++i) {
    static_cast<PlainLane&>(lanes[i]) = PlainLane{};
    RayScene::Surfel s;
    if (hits.kind[i] == HitKind::kNone || !scene.resolve(hits, i, view.camera, ray_model[i], s)) continue;
    light(view, ray_cam[i], s, lanes[i]);
    lanes[i].guest = hits.guest[i];
    lanes[i].lamp = lamp_light(light_.lamp, s.normal, s.albedo);
    if (!lanes[i].lit || !light_.shadow) continue;
    if (known != nullptr && known[i] != Shade::kUnknown) {
      if (known[i] == Shade::kDark) darken(lanes[i]);
      continue;
    }
    const Vec3d origin = view.camera + s.t * ray_model[i];
    const Vec3d to_light = view.projector - origin;
    set_lane(shadows, i, origin, to_light, kShadowOffsetMm / to_light.norm(), 1.0);
    any = true;
  }
  if (!any) return;
  std::array<bool, kPacket> blocked{};
  scene.occluded(shadows, blocked);
  for (std::size_t i = 0; i < n; ++i) {
    if (blocked[i]) darken(lanes[i]);
  }
}

}  // namespace enamel::twin
